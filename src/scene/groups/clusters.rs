//! Rigid clusters: balls that move as one body.

use crate::{
    error::Result,
    linalg::ROUNDING,
    scene::{entry::Entry, table::Table},
};

/// The shape of rigid clusters.
#[derive(Debug, Clone, PartialEq)]
pub struct Cluster {
    /// Which it is.
    pub form: ClusterForm,
    /// Distance of the centres of neighbours in diameters, at least 1.
    pub spacing: f64,
}

/// How the balls of a cluster lie.
#[derive(Debug, Clone, PartialEq)]
pub enum ClusterForm {
    /// So many in a row along x.
    Rod(usize),
    /// One and its four neighbours in a plane.
    Cross,
    /// Three that are neighbours.
    Triangle,
    /// Four that are neighbours, in 3D.
    Tetrahedron,
    /// At these places from the cluster's centre, moved so that this is their mean.
    Offsets(Vec<Vec<f64>>),
}

/// A word of a scene file, and the form that it names, of so many balls if it is a rod.
type Word = (&'static str, fn(usize) -> ClusterForm);

/// Words of the forms.
const WORDS: [Word; 4] = [
    ("rod", ClusterForm::Rod),
    ("cross", |_| ClusterForm::Cross),
    ("triangle", |_| ClusterForm::Triangle),
    ("tetrahedron", |_| ClusterForm::Tetrahedron),
];

impl Cluster {
    /// How many balls it has.
    pub fn balls(&self) -> usize {
        match &self.form {
            ClusterForm::Rod(balls) => *balls,
            other => other.unit_places().len(),
        }
    }

    /// Places of its balls of this radius about their mean, not turned; third components are 0 in 2D.
    pub fn places(&self, radius: f64) -> Vec<[f64; 3]> {
        let scale = if let ClusterForm::Offsets(_) = self.form { 1.0 } else { 2.0 * radius * self.spacing };
        let places = self.form.unit_places();
        let mean = |axis: usize| places.iter().map(|place| place[axis]).sum::<f64>() / places.len() as f64;
        let middle = [mean(0), mean(1), mean(2)];
        places.iter().map(|place| std::array::from_fn(|axis| scale * (place[axis] - middle[axis]))).collect()
    }
}

impl ClusterForm {
    /// Its word; none for one that is given place by place.
    pub(in crate::scene) fn word(&self) -> Option<&'static str> {
        match self {
            ClusterForm::Rod(_) => Some("rod"),
            ClusterForm::Cross => Some("cross"),
            ClusterForm::Triangle => Some("triangle"),
            ClusterForm::Tetrahedron => Some("tetrahedron"),
            ClusterForm::Offsets(_) => None,
        }
    }

    /// Places of balls whose neighbours are a unit away.
    fn unit_places(&self) -> Vec<[f64; 3]> {
        let height = 0.75_f64.sqrt();
        match self {
            ClusterForm::Rod(balls) => (0..*balls).map(|ball| [ball as f64, 0.0, 0.0]).collect(),
            ClusterForm::Cross => vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]],
            ClusterForm::Triangle => vec![[0.0; 3], [1.0, 0.0, 0.0], [0.5, height, 0.0]],
            ClusterForm::Tetrahedron => {
                vec![[0.0; 3], [1.0, 0.0, 0.0], [0.5, height, 0.0], [0.5, height / 3.0, (2.0_f64 / 3.0).sqrt()]]
            }
            ClusterForm::Offsets(offsets) => {
                offsets.iter().map(|offset| std::array::from_fn(|axis| offset.get(axis).copied().unwrap_or(0.0))).collect()
            }
        }
    }
}

/// The shape of clusters of balls of this radius.
pub(in crate::scene) fn read(table: &Table, dimension: usize, radius: f64) -> Result<Cluster> {
    let spacing = table.get("spacing").map_or(Ok(1.0), |entry| {
        let spacing = entry.positive()?;
        entry.expect((), table.get("offsets").is_none(), "is of shapes; offsets are lengths; remove it")?;
        entry.expect(spacing, spacing >= 1.0, "is in diameters of a ball; below 1 balls overlap")
    })?;
    let (name, entry) = table.exactly_one(&["shape", "offsets"], "shape = \"rod\"")?;
    let form = if name == "offsets" { read_offsets(&entry, dimension, radius)? } else { read_shape(table, &entry, dimension)? };
    Ok(Cluster { form, spacing })
}

fn read_shape(table: &Table, entry: &Entry, dimension: usize) -> Result<ClusterForm> {
    let form = entry.choice(&WORDS, &[])?(0);
    if form != ClusterForm::Rod(0) {
        table
            .get("beads")
            .map_or(Ok(()), |beads| beads.expect((), false, "is for rods; other shapes have a number of their own; remove it"))?;
        entry.expect(
            (),
            form != ClusterForm::Tetrahedron || dimension == 3,
            "is a shape in three dimensions; give domain.size three numbers",
        )?;
        return Ok(form);
    }
    let beads = table.require("beads", "5")?;
    let count = beads.count()?;
    beads.expect(ClusterForm::Rod(count), count >= 2, "must be at least 2; a ball alone goes to [[bodies]]")
}

fn read_offsets(entry: &Entry, dimension: usize, radius: f64) -> Result<ClusterForm> {
    let offsets: Vec<Vec<f64>> = entry.list()?.iter().map(|offset| offset.vector(dimension)).collect::<Result<_>>()?;
    entry.expect((), offsets.len() >= 2, "must hold at least two; a ball alone goes to [[bodies]]")?;
    for (second, other) in offsets.iter().enumerate() {
        for (first, one) in offsets[..second].iter().enumerate() {
            let distance = one.iter().zip(other).map(|(one, other)| (one - other).powi(2)).sum::<f64>().sqrt();
            let remedy =
                format!("balls {first} and {second} are {distance} apart and overlap; they must be at least {} apart", 2.0 * radius);
            entry.expect((), distance >= 2.0 * radius * (1.0 - ROUNDING), &remedy)?;
        }
    }
    Ok(ClusterForm::Offsets(offsets))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_of_every_shape_touch_and_none_overlap() {
        for form in [ClusterForm::Rod(4), ClusterForm::Cross, ClusterForm::Triangle, ClusterForm::Tetrahedron] {
            let cluster = Cluster { form, spacing: 1.0 };
            let places = cluster.places(0.5);
            let distance = |one: &[f64; 3], other: &[f64; 3]| (0..3).map(|axis| (one[axis] - other[axis]).powi(2)).sum::<f64>().sqrt();
            for (second, other) in places.iter().enumerate().skip(1) {
                let nearest = places[..second].iter().map(|one| distance(one, other)).fold(f64::INFINITY, f64::min);
                assert!((nearest - 1.0).abs() < 1e-12, "{nearest} {:?}", cluster.form);
            }
            assert!((0..3).all(|axis| places.iter().map(|place| place[axis]).sum::<f64>().abs() < 1e-12));
        }
    }
}
