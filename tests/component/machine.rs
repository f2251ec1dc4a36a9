//! The machine: ranks, vectors, matrices and scatters.

use std::{
    ops::Range,
    thread::sleep,
    time::{Duration, Instant},
};

use turbid::{
    error::Error,
    parallel::Routes,
    petsc::{Matrix, Profile, RowBuilder, Scatter, Session, Stage, StageCounts, Vector, WantedRun, enter},
};

use crate::Test;

/// Sums of a few dozen numbers of order one, or of integers, are right to this.
const ROUNDING: f64 = 1e-12;

pub fn tests() -> Vec<Test> {
    vec![
        Test::of(sums_and_largest_values_run_over_all_ranks),
        Test::of(gathered_values_stand_in_the_order_of_the_ranks),
        Test::of(letters_reach_those_they_are_for_in_the_order_of_the_ranks_that_sent_them),
        Test::of(copies_follow_their_routes_again_and_again),
        Test::of(a_broadcast_text_reaches_every_rank),
        Test::of(ranks_that_all_succeed_keep_their_own_values),
        Test::of(an_error_on_one_rank_becomes_an_error_on_all_with_its_exit_code),
        Test::of(the_first_of_two_errors_is_the_one_agreed_on),
        Test::of(local_parts_of_a_vector_follow_one_another),
        Test::of(dot_norm_and_mean_run_over_all_ranks),
        Test::of(vectors_add_scale_copy_and_lose_their_mean),
        Test::of(matrix_entries_of_equal_column_add_up_on_any_rank),
        Test::of(a_matrix_maps_between_vectors_of_different_length),
        Test::of(a_nest_acts_as_its_blocks_do_one_by_one),
        Test::of(a_scatter_fetches_entries_of_any_rank_in_the_order_asked_for),
        Test::of(places_added_back_add_up),
        Test::of(runs_of_entries_come_to_their_places_and_others_stay_zero),
        Test::of(a_petsc_error_names_the_call_and_says_why),
        Test::of(a_stage_counts_without_those_entered_in_it),
    ]
}

fn sums_and_largest_values_run_over_all_ranks(session: &Session) {
    let (rank, size) = place(session);
    let mut values = [rank as f64, 1.0];
    session.world().sum(&mut values);
    assert_eq!(values, [(size * (size - 1) / 2) as f64, size as f64]);
    assert_eq!(session.world().max(-(rank as f64)), 0.0);
    assert_eq!(session.world().max(rank as f64), (size - 1) as f64);
}

fn gathered_values_stand_in_the_order_of_the_ranks(session: &Session) {
    let (rank, size) = place(session);
    // rank 0 has nothing to give
    let gathered = session.world().gather(&vec![rank as f64; rank]);
    let expected: Vec<f64> = (0..size).flat_map(|rank| vec![rank as f64; rank]).collect();
    assert_eq!(gathered, expected);
    let gathered = session.world().gather(&[rank as i32, -1]);
    assert_eq!(gathered, (0..size as i32).flat_map(|rank| [rank, -1]).collect::<Vec<_>>());
}

/// How many numbers a rank sends another one in a round; often none.
fn letter_length(round: usize, from: usize, to: usize) -> usize {
    (7 * round + 3 * from + 5 * to) % 4 * usize::from(!(round + from + to).is_multiple_of(3)) * if round % 10 == 9 { 10_000 } else { 1 }
}

fn letters_reach_those_they_are_for_in_the_order_of_the_ranks_that_sent_them(session: &Session) {
    let (rank, size) = place(session);
    let letter = |round: usize, from: usize, to: usize| vec![(1000 * round + 100 * from + to) as f64; letter_length(round, from, to)];
    for round in 0..200 {
        // ranks come to a round at different times
        if round % 20 == rank {
            sleep(Duration::from_millis(2));
        }
        let letters: Vec<Vec<f64>> = (0..size).map(|to| letter(round, rank, to)).collect();
        let counts: Vec<usize> = letters.iter().map(Vec::len).collect();
        let (received, from) = session.world().send(&letters.concat(), &counts);
        let expected: Vec<Vec<f64>> = (0..size).map(|from| letter(round, from, rank)).collect();
        assert_eq!(received, expected.concat(), "round {round}");
        assert_eq!(from, expected.iter().map(Vec::len).collect::<Vec<_>>());
    }
}

fn copies_follow_their_routes_again_and_again(session: &Session) {
    let (rank, size) = place(session);
    // each rank wants some of the things of every rank, itself included, and none of some
    let wanted: Vec<Vec<usize>> = (0..size).map(|from| (0..letter_length(1, from, rank)).map(|thing| 2 * thing + 1).collect()).collect();
    let routes = Routes::asking(session.world().into(), &wanted);
    for round in 0..20 {
        let copies = routes.copies(session.world().into(), |thing| [(100 * rank + thing) as f64, round as f64]);
        let expected: Vec<[f64; 2]> = wanted
            .iter()
            .enumerate()
            .flat_map(|(from, things)| things.iter().map(move |thing| [(100 * from + thing) as f64, round as f64]))
            .collect();
        assert_eq!(copies, expected);
    }
    let sources: Vec<usize> = wanted.iter().enumerate().flat_map(|(from, things)| vec![from; things.len()]).collect();
    assert!(routes.sources().eq(sources));
}

fn a_broadcast_text_reaches_every_rank(session: &Session) {
    let (rank, size) = place(session);
    for root in 0..size {
        let own = format!("rank {rank} says é{}", "!".repeat(rank));
        let heard = session.world().broadcast(root, &own);
        assert_eq!(heard, format!("rank {root} says é{}", "!".repeat(root)));
    }
    assert_eq!(session.world().broadcast(size - 1, if rank == size - 1 { "" } else { "not me" }), "");
}

fn ranks_that_all_succeed_keep_their_own_values(session: &Session) {
    let (rank, _) = place(session);
    assert_eq!(session.world().agree(Ok(rank)).unwrap(), rank);
}

fn an_error_on_one_rank_becomes_an_error_on_all_with_its_exit_code(session: &Session) {
    let (rank, size) = place(session);
    for guilty in 0..size {
        let refused = || Error::refused("no such key");
        let error = session.world().agree(if rank == guilty { Err(refused()) } else { Ok(()) }).unwrap_err();
        assert_eq!((error.to_string().as_str(), error.exit_code()), ("no such key", 2));
        let diverged = || Error::Diverged("too slow".into());
        let error = session.world().agree(if rank == guilty { Err(diverged()) } else { Ok(()) }).unwrap_err();
        let expected = if rank == guilty { "too slow".to_string() } else { format!("rank {guilty}: too slow") };
        assert_eq!((error.to_string(), error.exit_code()), (expected, 1));
    }
}

fn the_first_of_two_errors_is_the_one_agreed_on(session: &Session) {
    let (rank, size) = place(session);
    // the first rank's error has exit code 2, the others' 1
    let outcome = if rank == 0 { Error::refused("first") } else { Error::Diverged("later".into()) };
    let error = session.world().agree::<()>(Err(outcome)).unwrap_err();
    assert_eq!((error.to_string().as_str(), error.exit_code()), ("first", 2));
    let outcome = if rank + 1 == size { Err(Error::refused("last")) } else { Ok(()) };
    assert_eq!(session.world().agree(outcome).unwrap_err().exit_code(), 2);
}

fn local_parts_of_a_vector_follow_one_another(session: &Session) {
    let vector = filled(session, 11, |index| index as f64);
    let all = session.world().gather(&vector.local().unwrap());
    assert_eq!(all, (0..11).map(f64::from).collect::<Vec<_>>());
    // one rank may have nothing
    let empty_first = Vector::new(session, place(session).0).unwrap();
    assert_eq!(empty_first.local().unwrap().len(), place(session).0);
    assert_eq!(empty_first.norm().unwrap(), 0.0);
}

fn dot_norm_and_mean_run_over_all_ranks(session: &Session) {
    let counting = filled(session, 10, |index| index as f64);
    let ones = filled(session, 10, |_| 1.0);
    assert_eq!(counting.dot(&ones).unwrap(), 45.0);
    assert_eq!(counting.dot(&counting).unwrap(), 285.0);
    assert!((counting.norm().unwrap() - 285f64.sqrt()).abs() < ROUNDING);
    assert_eq!(counting.mean().unwrap(), 4.5);
}

fn vectors_add_scale_copy_and_lose_their_mean(session: &Session) {
    let counting = filled(session, 9, |index| index as f64);
    let mut other = counting.like().unwrap();
    assert_eq!(other.norm().unwrap(), 0.0);
    other.fill(3.0).unwrap();
    other.add(2.0, &counting).unwrap();
    other.scale(0.5).unwrap();
    assert_eq!(entries(&other), (0..9).map(|index| 1.5 + f64::from(index)).collect::<Vec<_>>());
    other.remove_mean().unwrap();
    assert_eq!(entries(&other), (0..9).map(|index| f64::from(index) - 4.0).collect::<Vec<_>>());
    other.copy_from(&counting).unwrap();
    assert_eq!(entries(&other), entries(&counting));
}

fn matrix_entries_of_equal_column_add_up_on_any_rank(session: &Session) {
    const N: usize = 13;
    let matrix = assembled(session, (N, N), |row| vec![(row, 1.0), (N - 1 - row, 5.0), (row, 2.0), ((row + 1) % N, -1.0), (row, 0.5)]);
    let input = |index: usize| (index * index) as f64;
    let mut output = filled(session, N, |_| 7.0);
    matrix.multiply(&filled(session, N, input), &mut output).unwrap();
    let product = |row: usize| 3.5 * input(row) + 5.0 * input(N - 1 - row) - input((row + 1) % N);
    assert_eq!(entries(&output), (0..N).map(product).collect::<Vec<_>>());
    matrix.multiply_add(&filled(session, N, input), &mut output).unwrap();
    assert_eq!(entries(&output), (0..N).map(|row| 2.0 * product(row)).collect::<Vec<_>>());
}

fn a_matrix_maps_between_vectors_of_different_length(session: &Session) {
    // sums over pairs; the last row is empty
    let matrix = assembled(session, (6, 10), |row| if row < 5 { vec![(2 * row, 1.0), (2 * row + 1, 1.0)] } else { vec![] });
    let mut output = filled(session, 6, |_| 7.0);
    matrix.multiply(&filled(session, 10, |index| index as f64), &mut output).unwrap();
    assert_eq!(entries(&output), [1.0, 5.0, 9.0, 13.0, 17.0, 0.0]);
}

fn a_nest_acts_as_its_blocks_do_one_by_one(session: &Session) {
    let square = assembled(session, (7, 7), |row| vec![(row, 2.0), ((row + 3) % 7, 1.0)]);
    let wide = assembled(session, (5, 7), |row| vec![(row + 2, 1.0), (0, row as f64)]);
    let tall = assembled(session, (7, 5), |row| vec![(row % 5, 1.0)]);
    let nest = Matrix::nest(session, &[vec![Some(&square), Some(&tall)], vec![Some(&wide), None]]).unwrap();
    let (first, second) = (filled(session, 7, |index| index as f64), filled(session, 5, |index| 10.0 + index as f64));
    let (mut upper, mut lower) = (first.like().unwrap(), second.like().unwrap());
    square.multiply(&first, &mut upper).unwrap();
    tall.multiply_add(&second, &mut upper).unwrap();
    wide.multiply(&first, &mut lower).unwrap();
    let joined = |first: &Vector, second: &Vector| [&*first.local().unwrap(), &*second.local().unwrap()].concat();
    let mut input = Vector::new(session, share(session, 7).len() + share(session, 5).len()).unwrap();
    let mut output = input.like().unwrap();
    input.local_mut().unwrap().copy_from_slice(&joined(&first, &second));
    nest.multiply(&input, &mut output).unwrap();
    assert_eq!(*output.local().unwrap(), joined(&upper, &lower));
    assert!(output.norm().unwrap() > 0.0);
}

fn a_scatter_fetches_entries_of_any_rank_in_the_order_asked_for(session: &Session) {
    let vector = filled(session, 12, |index| 100.0 + index as f64);
    let wanted = wanted(session);
    let mut scatter = Scatter::new(&vector, &wanted).unwrap();
    let expected: Vec<f64> = wanted.iter().map(|&index| 100.0 + index as f64).collect();
    assert_eq!(*scatter.fetch(&vector).unwrap(), expected);
    let squares = filled(session, 12, |index| (index * index) as f64);
    let expected: Vec<f64> = wanted.iter().map(|&index| (index * index) as f64).collect();
    assert_eq!(*scatter.fetch(&squares).unwrap(), expected);
}

fn places_added_back_add_up(session: &Session) {
    let mut vector = filled(session, 12, |_| 0.5);
    let mut scatter = Scatter::new(&vector, &wanted(session)).unwrap();
    scatter.fetch(&vector).unwrap();
    assert!(scatter.places().iter().all(|&place| place == 0.0));
    scatter.places().fill(1.0);
    scatter.add_back(&mut vector).unwrap();
    let asked = session.world().gather(&wanted(session));
    let times = |index: usize| asked.iter().filter(|&&other| other == index).count() as f64;
    assert_eq!(entries(&vector), (0..12).map(|index| 0.5 + times(index)).collect::<Vec<_>>());
}

fn runs_of_entries_come_to_their_places_and_others_stay_zero(session: &Session) {
    let mut vector = filled(session, 12, |index| 100.0 + index as f64);
    // the part of the next rank, behind a place without an entry, then the first and the last entry of all
    let (rank, size) = place(session);
    let next = session.world().gather(&[share(session, 12).start, share(session, 12).end])[2 * ((rank + 1) % size)..][..2].to_vec();
    let length = next[1] - next[0];
    let single = |place, first| WantedRun { place, first, length: 1 };
    let runs = [WantedRun { place: 1, first: next[0], length }, single(length + 1, 0), single(length + 3, 11)];
    let mut scatter = Scatter::of_runs(&vector, length + 4, runs.into_iter()).unwrap();
    let values = |numbers: &mut dyn Iterator<Item = usize>| numbers.map(|index| 100.0 + index as f64).collect::<Vec<f64>>();
    let expected = [vec![0.0], values(&mut (next[0]..next[1])), vec![100.0, 0.0, 111.0]].concat();
    assert_eq!(*scatter.fetch(&vector).unwrap(), expected);
    scatter.places().fill(1.0);
    scatter.add_back(&mut vector).unwrap();
    let times = |index: usize| 1 + if index == 0 || index == 11 { size } else { 0 };
    assert_eq!(entries(&vector), (0..12).map(|index| (100 + index + times(index)) as f64).collect::<Vec<_>>());
}

fn a_petsc_error_names_the_call_and_says_why(session: &Session) {
    let matrix = assembled(session, (60, 60), |row| vec![(row, 1.0)]);
    let error = matrix.multiply(&filled(session, 64, |_| 1.0), &mut filled(session, 60, |_| 0.0)).unwrap_err();
    let Error::Petsc { call, code, text } = &error else { panic!("{error:?}") };
    assert_eq!((*call, *code), ("MatMult", 60));
    assert!(text.contains("global dim 60 64"), "{text}");
    assert!(error.to_string().starts_with("MatMult failed with PETSc error 60: "), "{error}");
}

/// Entries of all parts of a vector of 12, repeated, in no order.
fn wanted(session: &Session) -> Vec<usize> {
    match place(session).0 {
        0 => vec![11, 0, 5, 11, 6],
        1 => vec![],
        rank => vec![rank, 0, 0],
    }
}

/// The matrix with the given entries in each row.
pub fn assembled(session: &Session, (rows, columns): (usize, usize), row: impl Fn(usize) -> Vec<(usize, f64)>) -> Matrix {
    let mut builder = RowBuilder::default();
    for index in share(session, rows) {
        row(index).into_iter().for_each(|(column, value)| builder.push(column, value));
        builder.end_row();
    }
    Matrix::from_rows(session, share(session, columns).len(), builder).unwrap()
}

/// The vector of a function of the index.
pub fn filled(session: &Session, length: usize, value: impl Fn(usize) -> f64) -> Vector {
    let range = share(session, length);
    let mut vector = Vector::new(session, range.len()).unwrap();
    vector.local_mut().unwrap().iter_mut().zip(range).for_each(|(entry, index)| *entry = value(index));
    vector
}

fn entries(vector: &Vector) -> Vec<f64> {
    vector.session().world().gather(&vector.local().unwrap())
}

/// This rank's part of `length` entries; parts differ in length.
pub fn share(session: &Session, length: usize) -> Range<usize> {
    let (rank, size) = place(session);
    let cut = |rank: usize| length * rank * (rank + 1) / (size * (size + 1));
    cut(rank)..cut(rank + 1)
}

/// This rank, and how many there are.
pub fn place(session: &Session) -> (usize, usize) {
    (session.world().rank(), session.world().size())
}

fn a_stage_counts_without_those_entered_in_it(session: &Session) {
    let (_, size) = place(session);
    // nobody keeps a profile yet
    drop(enter(Stage::Output));
    let start = Instant::now();
    let profile = Profile::start().unwrap();
    let outer = enter(Stage::SetUp);
    sleep(Duration::from_millis(20));
    let inner = enter(Stage::Assembly);
    sleep(Duration::from_millis(60));
    session.world().sum(&mut [1.0, 2.0]);
    drop(inner);
    drop(outer);
    let counts = profile.finish().unwrap();
    let elapsed = start.elapsed().as_secs_f64();
    let of = |stage: Stage| *counts.iter().find(|counts| counts.stage == stage).unwrap();
    let StageCounts { seconds, bytes, collectives, .. } = of(Stage::Assembly);
    assert!(seconds >= 0.06 && of(Stage::SetUp).seconds >= 0.02);
    assert!(counts.iter().map(|counts| counts.seconds).sum::<f64>() <= elapsed, "stages overlap");
    let shared = f64::from(u8::from(size > 1));
    assert_eq!((collectives, bytes), (shared, 16.0 * shared));
    assert_eq!((of(Stage::Output).seconds, of(Stage::SetUp).collectives), (0.0, 0.0));
}
