//! The two kinds of scaling.

/// Whether the scene grows with the ranks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ScalingKind {
    /// The same scene.
    Strong,
    /// As many times the bodies and the volume.
    Weak,
}

impl ScalingKind {
    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            ScalingKind::Strong => "strong",
            ScalingKind::Weak => "weak",
        }
    }
}
