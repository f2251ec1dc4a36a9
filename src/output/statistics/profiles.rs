//! `profiles.csv` and `profiles.svg`: means over frames of what bodies and fluid do in slices across axes, with their intervals.

use crate::output::AXES;
use crate::{
    observe::{SliceSample, statistics::interval},
    picture::{Bar, Chart, Notes, Scale, Series},
};

/// Height of a chart in pixels.
const HEIGHT: usize = 450;

/// Frames of the slices across an axis.
#[derive(Debug, Clone)]
pub struct ProfileFrames {
    /// The axis.
    pub axis: usize,
    /// Middles of the slices.
    pub places: Vec<f64>,
    /// The slices of each frame.
    pub frames: Vec<Vec<SliceSample>>,
}

/// A mean and half the width of its 95 % interval; not a number where there is none.
#[derive(Debug, Clone, Copy)]
struct Mean {
    value: f64,
    half_width: f64,
}

/// A named number of each slice.
struct ProfileColumn {
    name: String,
    means: Vec<Mean>,
}

impl ProfileFrames {
    fn columns(&self) -> Vec<ProfileColumn> {
        let Some(first) = self.frames.first().and_then(|frame| frame.first()) else { return Vec::new() };
        let dimension = first.particles.len();
        let slices = 0..self.places.len();
        let column = |name: String, value: &dyn Fn(&SliceSample) -> f64, weight: &dyn Fn(&SliceSample) -> f64| ProfileColumn {
            name,
            means: slices
                .clone()
                .map(|slice| Mean::of(self.frames.iter().map(|frame| (value(&frame[slice]), weight(&frame[slice])))))
                .collect(),
        };
        let same = |_: &SliceSample| 1.0;
        let mut columns = vec![column("fraction".into(), &|sample| sample.fraction, &same)];
        for (axis, letter) in AXES.iter().enumerate().take(dimension) {
            let name = format!("particle_velocity_{letter}");
            columns.push(column(name, &|sample| sample.particles[axis], &|sample| sample.fraction));
        }
        for (axis, letter) in AXES.iter().enumerate().take(dimension) {
            let name = format!("fluid_velocity_{letter}");
            columns.push(column(name, &|sample| sample.fluid[axis], &|sample| 1.0 - sample.fraction));
        }
        if !first.stress.is_empty() {
            for (row, other) in (0..dimension).flat_map(|row| (row..dimension).map(move |other| (row, other))) {
                let name = format!("particle_stress_{}{}", AXES[row], AXES[other]);
                let value = |sample: &SliceSample| 0.5 * (sample.stress[row * dimension + other] + sample.stress[other * dimension + row]);
                columns.push(column(name, &value, &same));
            }
        }
        // a dry run has no fluid, and empty slices may be those of every frame
        columns.retain(|column| !column.name.starts_with("fluid") || column.means.iter().any(|mean| mean.value.is_finite()));
        columns
    }

    /// The table of several axes.
    pub fn csv(all: &[ProfileFrames]) -> String {
        let mut text = String::new();
        for (frames, columns) in all.iter().map(|frames| (frames, frames.columns())) {
            if text.is_empty() {
                let names = columns.iter().map(|column| format!("{0},{0}_half_width", column.name)).collect::<Vec<_>>();
                text = format!("axis,position,{}\n", names.join(","));
            }
            for (slice, place) in frames.places.iter().enumerate() {
                let cells = columns.iter().flat_map(|column| [column.means[slice].value, column.means[slice].half_width]);
                let cells = cells.map(|number| if number.is_finite() { format!("{number:?}") } else { String::new() });
                text += &format!("{},{place:?},{}\n", AXES[frames.axis], cells.collect::<Vec<_>>().join(","));
            }
        }
        text
    }

    /// Charts of several axes, one below the other.
    pub fn svg(title: &str, all: &[ProfileFrames]) -> String {
        let charts: Vec<String> = all.iter().flat_map(|frames| frames.charts(title)).collect();
        let height = HEIGHT * charts.len();
        let head = format!("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"800\" height=\"{height}\" viewBox=\"0 0 800 {height}\">\n");
        let below = |(number, chart): (usize, &String)| chart.replacen("<svg ", &format!("<svg y=\"{}\" ", HEIGHT * number), 1);
        head + &charts.iter().enumerate().map(below).collect::<String>() + "</svg>\n"
    }

    fn charts(&self, title: &str) -> Vec<String> {
        let columns = self.columns();
        let named = |part: &str| columns.iter().filter(|column| column.name.contains(part)).collect::<Vec<_>>();
        // of the velocities the component that differs most
        let spread = |axis: &&str| named(&format!("velocity_{axis}")).iter().map(|column| column.spread()).fold(0.0, f64::max);
        // the first of those that differ equally
        let widest = AXES.iter().rev().max_by(|one, other| spread(one).total_cmp(&spread(other))).expect("there are axes");
        let groups = [
            (format!("velocity along {widest}"), named(&format!("velocity_{widest}"))),
            ("solid fraction".into(), named("fraction")),
            ("particle stress".into(), named("stress")),
        ];
        let groups = groups.into_iter().filter(|(_, columns)| !columns.is_empty());
        groups.map(|(name, columns)| self.chart(&format!("{title}: {name}"), &name, &columns)).collect()
    }

    fn chart(&self, title: &str, name: &str, columns: &[&ProfileColumn]) -> String {
        let (mut series, mut notes) = (Vec::new(), Notes::default());
        for (number, column) in columns.iter().enumerate() {
            let points = || self.places.iter().zip(&column.means);
            series.push(Series { name: column.words(), points: points().map(|(place, mean)| (*place, mean.value)).collect() });
            let bar = |(x, Mean { value, half_width }): (&f64, &Mean)| Bar {
                series: number,
                x: *x,
                ends: [value - half_width, value + half_width],
            };
            notes.bars.extend(points().map(bar));
        }
        let x = format!("{}, across the box", AXES[self.axis]);
        Chart { title: title.into(), x, y: name.into(), scale: Scale::Linear, series }.annotated(&notes)
    }
}

impl ProfileColumn {
    fn spread(&self) -> f64 {
        let finite = || self.means.iter().map(|mean| mean.value).filter(|value| value.is_finite());
        finite().fold(f64::NEG_INFINITY, f64::max) - finite().fold(f64::INFINITY, f64::min)
    }

    /// Its name in a chart.
    fn words(&self) -> String {
        match self.name.split_once('_') {
            Some(("fluid", _)) => "fluid".into(),
            Some(("particle", rest)) if rest.starts_with("velocity") => "bodies".into(),
            Some((_, rest)) => rest.trim_start_matches("stress_").to_owned(),
            None => self.name.clone(),
        }
    }
}

impl Mean {
    /// Of values with weights, frame by frame; those that are not there have no part.
    fn of(samples: impl Iterator<Item = (f64, f64)>) -> Mean {
        let samples: Vec<(f64, f64)> = samples.filter(|(value, weight)| value.is_finite() && *weight > 0.0).collect();
        let weights = samples.iter().map(|(_, weight)| weight).sum::<f64>();
        let value = samples.iter().map(|(value, weight)| value * weight).sum::<f64>() / weights;
        let mean_weight = weights / samples.len() as f64;
        let scatter: Vec<f64> = samples.iter().map(|(sample, weight)| value + weight * (sample - value) / mean_weight).collect();
        Mean { value, half_width: interval(&scatter).map_or(f64::NAN, |interval| interval.half_width) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(fraction: f64, velocity: f64) -> SliceSample {
        SliceSample { fraction, particles: vec![velocity, 0.0], fluid: vec![1.0, f64::NAN], stress: vec![1.0, 2.0, 4.0, 0.0] }
    }

    #[test]
    fn means_of_bodies_are_weighed_by_the_solid_and_have_intervals_with_enough_frames() {
        let frames = |count: usize| ProfileFrames {
            axis: 1,
            places: vec![0.5],
            frames: (0..count).map(|k| vec![if k / 2 % 2 == 0 { sample(0.1, 1.0) } else { sample(0.3, 2.0) }]).collect(),
        };
        let columns = frames(16).columns();
        let of = |name: &str| columns.iter().find(|column| column.name == name).map(|column| column.means[0]);
        let bodies = of("particle_velocity_x").unwrap_or(Mean { value: 0.0, half_width: 0.0 });
        assert!((bodies.value - 1.75).abs() < 1e-12 && bodies.half_width > 0.0, "{bodies:?}");
        assert_eq!(of("particle_stress_xy").map(|mean| mean.value), Some(3.0));
        assert!(of("fluid_velocity_y").is_none(), "{}", columns.len());
        let few = ProfileFrames::csv(&[frames(4)]);
        assert!(
            few.starts_with("axis,position,fraction,fraction_half_width,")
                && few.lines().nth(1).is_some_and(|row| row.starts_with("y,0.5,0.2,,"))
        );
        let chart = ProfileFrames::svg("disks", &[frames(16), frames(4)]);
        assert!(!chart.contains("NaN") && chart.matches("<svg ").count() == 7, "{chart}");
    }
}
