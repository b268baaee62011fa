//! A line that loses, doubles, reorders, damages and cuts frames, from a seed.

use crate::random::Random;

/// How bad a line is: probabilities for each frame.
#[derive(Clone, Copy, Debug, Default)]
pub struct Faults {
    /// It does not arrive.
    pub loss: f64,
    /// It arrives twice, at two times.
    pub duplication: f64,
    /// One to four of its bits arrive wrong.
    pub bits: f64,
    /// Its end does not arrive, and so it runs into the next one.
    pub truncation: f64,
    /// It is late, and others overtake it.
    pub delay: f64,
    /// How late at most, in ticks.
    pub latest: usize,
}

impl Faults {
    /// Each of them with this probability.
    pub fn each(probability: f64, latest: usize) -> Self {
        let p = probability;
        Self { loss: p, duplication: p, bits: p, truncation: p, delay: p, latest }
    }
}

/// One direction of a line. Times are ticks.
#[derive(Clone, Debug)]
pub struct NoisyLine {
    faults: Faults,
    random: Random,
    on_the_way: Vec<(u64, Vec<u8>)>,
    /// Frames that something happened to.
    pub spoiled: u64,
}

impl NoisyLine {
    /// A line with these faults.
    pub fn new(faults: Faults, seed: u64) -> Self {
        Self { faults, random: Random::new(seed), on_the_way: Vec::new(), spoiled: 0 }
    }

    /// From now on with other faults; what is on the way stays there.
    pub fn become_as(&mut self, faults: Faults) {
        self.faults = faults;
    }

    /// Sends bytes, frame by frame.
    pub fn send(&mut self, now: u64, bytes: &[u8]) {
        for frame in bytes.split_inclusive(|&byte| byte == 0) {
            self.send_frame(now, frame);
        }
    }

    fn send_frame(&mut self, now: u64, frame: &[u8]) {
        let Faults { loss, duplication, bits, truncation, delay, latest } = self.faults;
        let copies = 1 + usize::from(self.random.chance(duplication));
        for copy in 0..copies {
            let mut frame = frame.to_vec();
            let mut spoiled = copy > 0;
            if self.random.chance(loss) {
                self.spoiled += 1;
                continue;
            }
            if self.random.chance(bits) {
                for _ in 0..self.random.whole(1, 4) {
                    let at = self.random.whole(0, frame.len() * 8 - 1);
                    frame[at / 8] ^= 1 << (at % 8);
                }
                spoiled = true;
            }
            if self.random.chance(truncation) {
                frame.truncate(self.random.whole(0, frame.len() - 1));
                spoiled = true;
            }
            let late = self.random.chance(delay) || copy > 0;
            let due = now + 1 + if late { self.random.whole(0, latest) as u64 } else { 0 };
            self.spoiled += u64::from(spoiled || late);
            self.on_the_way.push((due, frame));
        }
    }

    /// What arrives now.
    pub fn receive(&mut self, now: u64) -> Vec<u8> {
        let mut bytes = Vec::new();
        self.on_the_way.retain(|(due, frame)| {
            let arrives = *due <= now;
            if arrives {
                bytes.extend_from_slice(frame);
            }
            !arrives
        });
        bytes
    }
}
