//! A job in the contour form: any text is refused in one line, or is a path whose pieces the controller's loader takes.
#![no_main]

use host_sim::job::Job;
use host_sim::path::Path;
use libfuzzer_sys::fuzz_target;
use shared::loader::Loader;
use shared::piece::Order;

fuzz_target!(|text: &str| {
    let path = Job::from_toml("job.toml", text).and_then(|job| Path::new(&job, Order::First));
    match path {
        Ok(path) => {
            let mut loader: Loader<f32> = Loader::new(&path.header, shared::TICK).expect("the host checks the header");
            for piece in path.wire() {
                loader.load(&piece).expect("the host checks every piece");
            }
        }
        Err(error) => assert_eq!(error.to_string().lines().count(), 1, "{error}"),
    }
});
