//! The facade; without features it is the shared words alone.
use siltflow::interfaces::Pose;

fn main() {
    #[cfg(feature = "default")]
    {
        let grid = siltflow::flow::CartesianGrid::new([4, 4], [1.0, 1.0]).expect("a valid grid");
        println!("siltflow: {} cells", grid.n_cells());
    }
    println!("siltflow: {:?}", Pose::at([0.0; 3]).position);
}
