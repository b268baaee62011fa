mod common;
use board::machine::servo_axes::{MILL, ServoAxes, velocity};
use board::run::run;
use board::line::{JobTalker, share};
use common::{image, servos, root, start_of};
use shared::piece::Order;
use host_sim::job::Job;
use host_sim::path::Path;
#[test]
fn look() {
    let job = Job::read(root().join("examples/farouki2018.toml").to_str().unwrap()).unwrap();
    let path = Path::new(&job, Order::First).unwrap();
    let pieces: Vec<_> = path.wire().collect();
    let start = start_of(&path.header, &pieces);
    let talker = share(JobTalker::new(path.header, pieces));
    let (seen, m) = run(&image(), &servos(), talker, 3.0, |p| {p.machine.servo_axes = Some(ServoAxes::new(MILL).unwrap().recording());}).unwrap();
    println!("{:?} {:?}", seen.statuses, m.enables.changes);
    let ex = m.servo_axes.unwrap().exchanges.unwrap();
    let first = seen.idle as usize - 1;
    for (k, t) in seen.ticks.iter().enumerate() {
        let e = ex[first+1+k];
        let sp = [0,1].map(|a| (t.setpoint[a]-start[a].0) as f64/262144.0);
        let ac = [0,1].map(|a| e[a].counter as i16 as f64/800.0);
        if k < 40 || k + 60 > seen.ticks.len() || k%100==0 { println!("{k} sp {sp:.3?} ac {ac:.3?} v {:.2?}", [0,1].map(|a| velocity(e[a].code))); }
    }
}
