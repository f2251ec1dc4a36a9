//! Angles of objects that are followed over turns from one row to the next.

use std::f64::consts::{FRAC_PI_2, TAU};

use crate::output::Columns;

/// Which column has an angle that is followed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AngleColumns {
    /// Of the angle over all turns.
    pub followed: &'static str,
    /// Of the angle itself, where the other one counts from the first row.
    pub plain: Option<&'static str>,
}

/// What angles of the next rows are counted from, object by object; empty before the first rows.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Turns {
    /// The angles that count as none.
    start: Vec<f64>,
    /// The followed angles of the last rows.
    last: Vec<f64>,
}

impl Turns {
    /// Those after the rows of a table with so many rows for each time; none where it has no rows.
    pub fn read(table: &str, names: AngleColumns, objects: usize) -> Turns {
        let mut lines = table.lines();
        let Some(header) = lines.next() else { return Turns::default() };
        let rows: Vec<&str> = lines.collect();
        let Some(before) = rows.len().checked_sub(objects) else { return Turns::default() };
        let column = |name: &str, rows: &[&str]| {
            let found = Columns::chosen(std::iter::once(&header).chain(rows), |own| own == name);
            found.column(name).map_or(Vec::new(), |column| column.iter().copied().filter(|angle| angle.is_finite()).collect())
        };
        let last = column(names.followed, &rows[before..]);
        let start = names.plain.map_or_else(|| vec![0.0; last.len()], |plain| column(plain, &rows[..objects]));
        if start.len() == last.len() { Turns { start, last } } else { Turns::default() }
    }

    /// They as numbers.
    pub fn pack(&self) -> Vec<f64> {
        [&self.start[..], &self.last].concat()
    }

    /// What [`pack`](Turns::pack) was given.
    pub fn unpack(numbers: &[f64]) -> Turns {
        let (start, last) = numbers.split_at(numbers.len() / 2);
        Turns { start: start.to_vec(), last: last.to_vec() }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.last.is_empty()
    }

    /// Whether one of these objects, each with its angle, has turned by more than a quarter since the last rows.
    pub fn quarter(&self, angles: &[(usize, f64)]) -> bool {
        angles.iter().any(|&(object, angle)| (self.followed(object, angle) - self.last[object]).abs() > FRAC_PI_2)
    }

    /// Goes on to the angles of new rows, of which the first are what the next count from where they `count` from there; gives what these are over turns.
    pub fn advance(&mut self, angles: &[f64], count: bool) -> &[f64] {
        if self.last.len() == angles.len() {
            self.last = angles.iter().enumerate().map(|(object, &angle)| self.followed(object, angle)).collect();
        } else {
            self.start = if count { angles.to_vec() } else { vec![0.0; angles.len()] };
            self.last = angles.iter().zip(&self.start).map(|(angle, start)| angle - start).collect();
        }
        &self.last
    }

    /// The angle nearest to that of the last row.
    fn followed(&self, object: usize, angle: f64) -> f64 {
        let since = angle - self.start[object];
        since + TAU * ((self.last[object] - since) / TAU).round()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TREAD: AngleColumns = AngleColumns { followed: "tread", plain: Some("phase") };

    fn within_a_turn(angle: f64) -> f64 {
        angle.sin().atan2(angle.cos())
    }

    #[test]
    fn angles_go_on_over_turns_either_way() {
        for count in [false, true] {
            let mut turns = Turns::default();
            let start = if count { [3.0, -2.0] } else { [0.0; 2] };
            for row in 0..40 {
                let angles = [3.0 + 1.4 * f64::from(row), -2.0 - 1.4 * f64::from(row)];
                let found = turns.advance(&angles.map(within_a_turn), count).to_vec();
                assert!((0..2).all(|place| (found[place] - angles[place] + start[place]).abs() < 1e-12), "{row}: {found:?}");
            }
        }
    }

    #[test]
    fn a_quarter_turn_is_noticed_and_less_is_not() {
        let mut turns = Turns::default();
        turns.advance(&[3.0, 0.0], true);
        assert!(!turns.quarter(&[(0, within_a_turn(4.5)), (1, -1.5)]));
        assert!(turns.quarter(&[(0, within_a_turn(4.6))]) && turns.quarter(&[(1, -1.6)]));
    }

    #[test]
    fn angles_go_on_from_a_table_as_if_they_had_not_stopped() {
        let mut whole = Turns::default();
        let mut table = "time,cell,phase,tread\n".to_owned();
        for row in 0..9 {
            let phases = [within_a_turn(0.1 + 1.3 * f64::from(row)), within_a_turn(2.0 - f64::from(row))];
            let treads = whole.advance(&phases, true);
            (0..2).for_each(|cell| table += &format!("{row},{cell},{:?},{:?}\n", phases[cell], treads[cell]));
        }
        let read = Turns::read(&table, TREAD, 2);
        assert_eq!((Turns::unpack(&read.pack()), &read), (whole, &read));
        assert_eq!(Turns::read("", TREAD, 2), Turns::default());
        // a chain with ends and a ring, which has no angle
        let some = Turns::read("time,chain,angle\n0.0,0,7.5\n0.0,1,\n", AngleColumns { followed: "angle", plain: None }, 2);
        assert_eq!(some, Turns { start: vec![0.0], last: vec![7.5] });
    }
}
