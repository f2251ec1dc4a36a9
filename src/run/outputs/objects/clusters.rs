//! `clusters.csv`: rigid clusters.

use nalgebra::{Matrix3, Rotation3, SMatrix, SVector};

use super::super::context::{Context, Wanted};
use super::table::{NamedNumber, ObjectRow, Objects, opened, vector};
use super::turns::AngleColumns;
use crate::{
    interaction::Cluster,
    observe::{aspect_ratio, longest_axis},
    run::View,
    setup::Moving,
};

/// The clusters of a run.
struct Clusters<const D: usize> {
    /// The number of the first.
    first: usize,
    clusters: Vec<OneCluster<D>>,
}

/// What a cluster is at all times.
struct OneCluster<const D: usize> {
    /// The number of its first ball.
    ball: usize,
    /// Where this is at the start, from the centre of the cluster.
    offset: SVector<f64, D>,
    /// The unit vector from that to the farthest ball at the start.
    axis: SVector<f64, D>,
    aspect_ratio: f64,
}

/// Where there are clusters, unless `output.objects = false`. Collective.
///
/// # Errors
/// The file cannot be read or written.
pub fn wanted<const D: usize>(context: &Context<D>) -> Wanted<D> {
    let Some(simulation) = context.simulation.filter(|_| context.scene.writes_objects()) else { return Ok(None) };
    let interactions = simulation.interactions();
    let one = |cluster: &Cluster<D>| OneCluster {
        ball: cluster.bodies.start,
        offset: cluster.offsets[0],
        axis: longest_axis(cluster),
        aspect_ratio: aspect_ratio(cluster),
    };
    opened(context, Clusters { first: interactions.chains().len(), clusters: interactions.clusters().iter().map(one).collect() })
}

/// Centre and rotation of the first ball of a cluster.
type Pose<const D: usize> = (SVector<f64, D>, SMatrix<f64, D, D>);

impl<const D: usize> Clusters<D> {
    /// The place of each cluster whose first ball this rank has, with the pose of that.
    fn poses(&self, view: &View<D>) -> Vec<(usize, Pose<D>)> {
        let Some(state) = view.motion.map(|motion| motion.state()) else { return Vec::new() };
        let pose = |body: &Moving<D>| (body.center, body.rotation);
        let places = self.clusters.iter().map(|cluster| state.place(cluster.ball)).enumerate();
        places.filter_map(|(cluster, place)| Some((cluster, pose(&state.bodies[place?])))).collect()
    }

    /// The poses of all clusters, in their order. Collective.
    fn all_poses(&self, view: &View<D>) -> Vec<Pose<D>> {
        let Some(motion) = view.motion else { return Vec::new() };
        let packed = |(cluster, (center, rotation)): (usize, Pose<D>)| [&[cluster as f64], center.as_slice(), rotation.as_slice()].concat();
        let numbers: Vec<f64> = self.poses(view).into_iter().flat_map(packed).collect();
        let all = motion.state().peers(view.world).gather(&numbers);
        let mut rows: Vec<&[f64]> = all.chunks(1 + D + D * D).collect();
        rows.sort_unstable_by(|one, other| one[0].total_cmp(&other[0]));
        let pose = |row: &[f64]| (SVector::from_column_slice(&row[1..=D]), SMatrix::from_column_slice(&row[1 + D..]));
        rows.into_iter().map(pose).collect()
    }
}

impl<const D: usize> OneCluster<D> {
    fn entries(&self, (center, rotation): &Pose<D>) -> Vec<NamedNumber> {
        let mut entries = vector("", &(center - rotation * self.offset));
        if D == 3 {
            let turn = Rotation3::from_matrix_unchecked(Matrix3::from_fn(|row, column| rotation[(row, column)])).scaled_axis();
            entries.extend(vector("rotation", &turn));
            entries.extend(vector("axis", &(rotation * self.axis)));
        }
        entries.push(("aspect_ratio".into(), self.aspect_ratio));
        entries
    }

    /// The angle from x of its long axis, in 2D.
    fn angle(&self, rotation: &SMatrix<f64, D, D>) -> f64 {
        let axis = rotation * self.axis;
        axis[1].atan2(axis[0])
    }
}

impl<const D: usize> Objects<D> for Clusters<D> {
    fn names(&self) -> [&'static str; 2] {
        ["clusters.csv", "cluster"]
    }

    fn count(&self) -> usize {
        self.clusters.len()
    }

    fn angle(&self) -> Option<AngleColumns> {
        (D == 2).then_some(AngleColumns { followed: "angle", plain: None })
    }

    fn angles(&self, view: &View<D>) -> Vec<(usize, f64)> {
        self.poses(view).into_iter().map(|(cluster, (_, rotation))| (cluster, self.clusters[cluster].angle(&rotation))).collect()
    }

    fn rows(&self, view: &View<D>) -> Vec<ObjectRow> {
        let row = |(number, (cluster, pose)): (usize, (&OneCluster<D>, Pose<D>))| ObjectRow {
            number,
            entries: cluster.entries(&pose),
            angle: (D == 2).then(|| cluster.angle(&pose.1)),
        };
        (self.first..).zip(self.clusters.iter().zip(self.all_poses(view))).map(row).collect()
    }
}
