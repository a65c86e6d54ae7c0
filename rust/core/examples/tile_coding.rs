//! Sarsa(λ) on tiles: stopped, saved, loaded and continued: `cargo run --release --example tile_coding`.

#![expect(clippy::print_stdout, reason = "a program that shows its results")]

use std::error::Error;
use std::{env, fs, process};

use qtab_core::envs::classic_control::MountainCar;
use qtab_core::features::TileCoding;
use qtab_core::learners::{AnyAlgorithm, TraceKind, TraceOptions};
use qtab_core::{AnyTrainer, BuildError, Trainer};

/// A car in a valley, whose position and velocity are covered by 8 tilings of 8 by 8 tiles.
fn new_run() -> Result<AnyTrainer<MountainCar, TileCoding<f32>>, BuildError> {
    let tiles = TileCoding::try_new(&[-1.2, -0.07], &[0.6, 0.07], &[8, 8], 8)?;
    Trainer::builder(MountainCar::default(), tiles)
        .algorithm(AnyAlgorithm::SarsaLambda(TraceOptions { kind: TraceKind::Replacing, decay: 0.9, cutoff: 1e-3 }))
        .max_episode_steps(200)
        .epsilon(0.0) // values that begin at 0 are better than any return, so the car explores
        .learning_rate(0.5)
        .discount(1.0)
        .seed(3)
        .build()
}

fn main() -> Result<(), Box<dyn Error>> {
    let path = env::temp_dir().join(format!("qtab_tile_coding_{}", process::id()));
    let mut trainer = new_run()?;
    trainer.train(200)?;
    fs::write(&path, trainer.save()?)?;
    println!(
        "saved after {} episodes: mean return {:.1}",
        trainer.episodes().len(),
        trainer.episodes().mean_return(50)
    );

    let mut resumed = new_run()?;
    let loaded = fs::read(&path).map_err(Box::<dyn Error>::from).and_then(|bytes| Ok(resumed.load(&bytes)?));
    fs::remove_file(&path)?;
    loaded?;
    resumed.train(300)?;
    println!("resumed to {} episodes: mean return {:.1}", resumed.episodes().len(), resumed.episodes().mean_return(50));

    // Resuming changes nothing.
    trainer.train(300)?;
    if trainer.tables() != resumed.tables() {
        return Err("the resumed run has learned other values".into());
    }
    let evaluation = resumed.evaluate(100, 1)?;
    println!("evaluated: mean return {:.1}", evaluation.mean_return(100));
    if evaluation.mean_return(100) < -130.0 {
        return Err("the car does not climb the hill".into());
    }
    Ok(())
}

#[test]
fn a_resumed_run_learns_the_same() {
    main().expect("the example runs");
}
