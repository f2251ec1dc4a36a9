//! The table of a profile: what each stage of a run took and sent.

use crate::{parallel::World, petsc::StageCounts};

/// Bytes in a megabyte.
const MEGA: f64 = 1e6;

/// A row for each stage that took place: seconds on the fastest rank, on average and on the slowest, and the share of
/// the whole; traffic and operations are means over the ranks. Collective.
pub fn stage_table(world: &World, stages: &[StageCounts]) -> String {
    let numbers = |counts: &StageCounts| [counts.seconds, counts.messages, counts.bytes, counts.collectives, counts.flops];
    let local: Vec<[f64; 5]> = stages.iter().map(numbers).collect();
    let all = world.gather(&local.concat());
    let ranks = world.size() as f64;
    let of_stage = |stage: usize| all.chunks(local.len() * 5).map(move |rank| &rank[stage * 5..(stage + 1) * 5]);
    let mean = |stage: usize, column: usize| of_stage(stage).map(|row| row[column]).sum::<f64>() / ranks;
    let whole: f64 = (0..stages.len()).map(|stage| mean(stage, 0)).sum();
    let mut lines = vec![
        "| stage | least s | mean s | most s | share | messages | MB | collectives | Mflop |".to_owned(),
        "|-|-|-|-|-|-|-|-|-|".to_owned(),
    ];
    for (number, stage) in stages.iter().enumerate() {
        let (least, most) = of_stage(number).fold((f64::INFINITY, 0.0_f64), |(least, most), row| (least.min(row[0]), most.max(row[0])));
        if most > 0.0 {
            let [seconds, messages, bytes, collectives, flops] = std::array::from_fn(|column| mean(number, column));
            let (name, share) = (stage.stage.name(), 100.0 * seconds / whole);
            let (megabytes, millions) = (bytes / MEGA, flops / MEGA);
            lines.push(format!(
                "| {name} | {least:.3} | {seconds:.3} | {most:.3} | {share:.1} % | {messages:.0} | {megabytes:.2} | {collectives:.0} \
                 | {millions:.0} |"
            ));
        }
    }
    lines.push(format!("| all | | {whole:.3} | | 100.0 % | | | | |"));
    lines.push(
        "Traffic and operations per rank as PETSc counts them: without those of hypre, of the files, and of the bodies' blocks.".into(),
    );
    lines.join("\n")
}
