//! `structure-factor.csv`: the structure factor of the places of bodies.

use std::fmt::Write;

use serde::Serialize;

use crate::{
    observe::ShellMean,
    picture::{Bar, Chart, Level, Notes, Scale, Series},
};

/// What a summary says of the structure factor.
#[derive(Debug, Clone, Serialize)]
pub struct StructureFactorSummary {
    /// Its largest value, and at which wave number.
    pub peak: ShellSummary,
    /// That of the longest waves, and their wave number.
    pub longest: ShellSummary,
    /// Configurations that were averaged.
    pub configurations: usize,
    /// Time of the first of them.
    pub from_time: f64,
}

/// The structure factor at a wave number.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct ShellSummary {
    /// The wave number.
    pub wave_number: f64,
    /// The structure factor.
    pub value: f64,
    /// Half the width of its 95 % interval, with eight configurations or more.
    pub half_width: Option<f64>,
}

impl StructureFactorSummary {
    /// Of the means of shells, the shortest first; nothing without any.
    pub fn new(shells: &[ShellMean], configurations: usize, from_time: f64) -> Option<StructureFactorSummary> {
        let of = |&ShellMean { wave_number, value, half_width, .. }: &ShellMean| ShellSummary { wave_number, value, half_width };
        let peak = shells.iter().max_by(|one, other| one.value.total_cmp(&other.value))?;
        Some(StructureFactorSummary { peak: of(peak), longest: of(shells.first()?), configurations, from_time })
    }
}

/// The files by name.
pub fn structure_factor_files(title: &str, shells: &[ShellMean]) -> [(&'static str, Vec<u8>); 2] {
    [("structure-factor.csv", table(shells).into_bytes()), ("structure-factor.svg", chart(title, shells).into_bytes())]
}

fn table(shells: &[ShellMean]) -> String {
    let mut text = "wave_number,structure_factor,half_width,vectors\n".to_owned();
    for ShellMean { wave_number, value, half_width, vectors } in shells {
        let half_width = half_width.map_or(String::new(), |half_width| format!("{half_width:?}"));
        writeln!(text, "{wave_number:?},{value:?},{half_width},{vectors:?}").expect("memory can be written");
    }
    text
}

fn chart(title: &str, shells: &[ShellMean]) -> String {
    let points = shells.iter().map(|shell| (shell.wave_number, shell.value)).collect();
    let bar = |shell: &ShellMean| {
        let half_width = shell.half_width?;
        Some(Bar { series: 0, x: shell.wave_number, ends: [shell.value - half_width, shell.value + half_width] })
    };
    let bars = shells.iter().filter_map(bar).collect();
    let notes = Notes { bars, levels: vec![Level { y: 1.0, name: "at random".into() }], ..Notes::default() };
    let (x, y) = ("wave number k (1/length)", "structure factor S(k)");
    let series = vec![Series { name: "S(k)".into(), points }];
    Chart { title: title.into(), x: x.into(), y: y.into(), scale: Scale::Linear, series }.annotated(&notes)
}
