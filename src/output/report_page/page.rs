//! What the page of a run shows.

use super::Table;
use crate::output::{Answer, MeanViscosity};

/// How a run stands.
#[derive(Debug, Clone, PartialEq)]
pub enum Standing {
    /// It has ended.
    Ended,
    /// It goes on, or was killed.
    UnderWay,
    /// It did not end, for this reason.
    Broken(String),
}

/// Parts that add up, such as a viscosity or seconds.
#[derive(Debug, Clone, PartialEq)]
pub struct Breakdown {
    /// What of.
    pub title: &'static str,
    /// Names and values.
    pub parts: Vec<(&'static str, f64)>,
    /// Decimals that are shown.
    pub decimals: usize,
}

/// Names and values under a title.
#[derive(Debug, Clone, PartialEq)]
pub struct Facts {
    /// Title.
    pub title: &'static str,
    /// Names and values.
    pub facts: Vec<(&'static str, String)>,
}

/// An image to be shown.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    /// Name of its file, which ends with `.svg` or `.png`.
    pub name: &'static str,
    /// Its contents; nothing if they are too large for a page.
    pub bytes: Vec<u8>,
}

/// What the page shows.
#[derive(Debug, Clone)]
pub struct Page {
    /// Title of the scene.
    pub title: String,
    /// How the run stands.
    pub standing: Standing,
    /// When the page was written, and how far the run was then.
    pub written: String,
    /// What the run answers.
    pub answers: Vec<Answer>,
    /// Tables for charts.
    pub tables: Vec<Table>,
    /// Mean viscosity, which a chart shows.
    pub mean: Option<MeanViscosity>,
    /// The picture, and others.
    pub images: Vec<Image>,
    /// What adds up.
    pub parts: Vec<Breakdown>,
    /// Header and rows of the table of bodies, if there are few.
    pub bodies: Option<(Vec<String>, Vec<Vec<String>>)>,
    /// Contacts, solver, run, machine.
    pub facts: Vec<Facts>,
    /// Text of the scene.
    pub scene: String,
    /// The last lines of the log.
    pub log: String,
    /// Names of files, and what they are.
    pub files: Vec<(String, &'static str)>,
}
