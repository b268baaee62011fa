//! A body under a constant push with viscous and Coulomb friction, in closed form.
//!
//! x'' = a - B x' - C sign(x'), and at rest nothing moves while |a| is at most the breakaway value. With constant a this has an exact
//! solution between two stops, so there is nothing to chatter: a body that comes to rest within a step stops at the instant that the
//! formula gives, and stays or leaves by the rule for rest. The push is constant over a step; what makes it vary (a spring, a
//! drive that samples) is the caller's, and so is the error of that.
//!
//! Covers: Coulomb friction with a higher breakaway value, viscous friction. Leaves out: the Stribeck slope between the two and
//! presliding, which are finer than an encoder count on the machines that this serves.

/// Position and velocity, in mm and mm/s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Body {
    /// mm.
    pub position: f64,
    /// mm/s.
    pub velocity: f64,
}

/// Friction of a body, divided by its mass.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Friction {
    /// B, viscous, in 1/s; 0 or more.
    pub viscous: f64,
    /// C, sliding, in mm/s^2; 0 or more.
    pub coulomb: f64,
    /// What it takes to leave rest, in mm/s^2; at least `coulomb`.
    pub breakaway: f64,
}

/// The motion over a time: e^(-B t), its integral and its second integral.
#[derive(Clone, Copy, Debug)]
struct Flow {
    decay: f64,
    gain: f64,
    reach: f64,
}

impl Flow {
    fn over(viscous: f64, time: f64) -> Self {
        let x = viscous * time;
        if x < 1e-3 {
            // The closed forms cancel here; the series is exact to 1e-16 at this bound.
            let gain = time * (1.0 - x / 2.0 * (1.0 - x / 3.0 * (1.0 - x / 4.0 * (1.0 - x / 5.0))));
            let reach = time * time / 2.0 * (1.0 - x / 3.0 * (1.0 - x / 4.0 * (1.0 - x / 5.0 * (1.0 - x / 6.0))));
            return Self { decay: 1.0 - viscous * gain, gain, reach };
        }
        let gain = -(-x).exp_m1() / viscous;
        Self { decay: (-x).exp(), gain, reach: (time - gain) / viscous }
    }

    fn apply(&self, body: Body, push: f64) -> Body {
        Body {
            position: body.position + body.velocity * self.gain + push * self.reach,
            velocity: body.velocity * self.decay + push * self.gain,
        }
    }
}

/// Steps of one length for one kind of friction.
#[derive(Clone, Copy, Debug)]
pub struct Glide {
    friction: Friction,
    time: f64,
    flow: Flow,
    dry: bool,
}

impl Glide {
    /// Prepares steps of `time` seconds.
    pub fn new(friction: Friction, time: f64) -> Self {
        let dry = friction.coulomb > 0.0 || friction.breakaway > 0.0;
        Self { friction, time, flow: Flow::over(friction.viscous, time), dry }
    }

    /// One step under the constant acceleration `push`, in mm/s^2.
    #[inline]
    pub fn advance(&self, body: Body, push: f64) -> Body {
        if self.dry { self.slide(body, push) } else { self.flow.apply(body, push) }
    }

    fn slide(&self, body: Body, push: f64) -> Body {
        let Friction { viscous, coulomb, breakaway } = self.friction;
        let (mut body, mut left, mut flow) = (body, self.time, self.flow);
        // A constant push can stop a body once and start it once: at most two pieces, and the second one does not stop.
        for _ in 0..2 {
            if body.velocity == 0.0 && push.abs() <= breakaway {
                return body;
            }
            let sense = if body.velocity == 0.0 { push.signum() } else { body.velocity.signum() };
            let net = push - sense * coulomb;
            let end = flow.apply(body, net);
            if end.velocity * sense >= 0.0 {
                return end;
            }
            // 0 = v e^(-B t) + net (1 - e^(-B t))/B; net opposes v, or the velocity could not have changed its sign.
            let ratio = -body.velocity / net;
            let time = if viscous * ratio < 1e-12 { ratio } else { (viscous * ratio).ln_1p() / viscous };
            body = Body { velocity: 0.0, ..Flow::over(viscous, time).apply(body, net) };
            left = (left - time).max(0.0);
            flow = Flow::over(viscous, left);
        }
        body
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(friction: Friction, push: f64, speed: f64, step: f64, steps: usize) -> Body {
        let glide = Glide::new(friction, step);
        (0..steps).fold(Body { position: 0.0, velocity: speed }, |body, _| glide.advance(body, push))
    }

    /// Viscous decay: v = v0 e^(-Bt), way v0 (1 - e^(-Bt))/B; with a push, towards push/B.
    #[test]
    fn viscous_decay_is_exact() {
        for viscous in [1e-6_f64, 0.3, 31.8344, 400.0] {
            let friction = Friction { viscous, ..Friction::default() };
            let (speed, push, time) = (120.0, 700.0, 0.25);
            let end = run(friction, push, speed, time / 1000.0, 1000);
            let decay = (-viscous * time).exp();
            let velocity = speed * decay + push * -(-viscous * time).exp_m1() / viscous;
            assert!((end.velocity / velocity - 1.0).abs() < 1e-9, "{viscous}");
            let way = (push * time + speed - velocity) / viscous;
            // The formula of the way cancels for a small B, the steps do not.
            assert!((end.position / way - 1.0).abs() < if viscous < 1e-3 { 1e-6 } else { 1e-9 }, "{viscous}");
        }
    }

    /// Under Coulomb friction alone a body stops after v^2/(2 C) exactly, wherever the steps fall, and then rests.
    #[test]
    fn a_sliding_body_stops_at_the_exact_distance() {
        let friction = Friction { viscous: 0.0, coulomb: 900.0, breakaway: 1200.0 };
        for step in [1e-4, 7.7e-4, 0.013, 1.0] {
            for speed in [100.0_f64, -37.0] {
                let end = run(friction, 0.0, speed, step, 2 + (1.0 / step) as usize);
                let way = speed * speed / (2.0 * 900.0) * speed.signum();
                assert!((end.position - way).abs() < 1e-12 && end.velocity == 0.0, "{step} {end:?}");
            }
        }
    }

    /// With both frictions: way v/B - C/B^2 ln(1 + v B/C).
    #[test]
    fn both_frictions_stop_at_the_exact_distance() {
        let friction = Friction { viscous: 20.0, coulomb: 500.0, breakaway: 500.0 };
        let end = run(friction, 0.0, 80.0, 3e-4, 3000);
        let way = 80.0 / 20.0 - 500.0 / 400.0 * (1.0_f64 + 80.0 * 20.0 / 500.0).ln();
        assert!((end.position - way).abs() < 1e-12 && end.velocity == 0.0, "{end:?} {way}");
    }

    /// At rest: nothing moves up to the breakaway value; above it the sliding value counts.
    #[test]
    fn a_body_sticks_until_breakaway() {
        let friction = Friction { viscous: 0.0, coulomb: 300.0, breakaway: 450.0 };
        for push in [0.0, 299.0, -450.0] {
            assert_eq!(run(friction, push, 0.0, 1e-3, 100), Body::default());
        }
        let end = run(friction, -450.1, 0.0, 1e-3, 100);
        assert!((end.velocity + 15.01).abs() < 1e-9 && (end.position + 150.1 * 0.01 / 2.0).abs() < 1e-9);
    }

    /// A push against the motion stops the body and takes it back within one step: v^2/(2 (p + C)) forth, then p - C back.
    #[test]
    fn a_reversal_within_a_step_is_exact() {
        let friction = Friction { viscous: 0.0, coulomb: 100.0, breakaway: 150.0 };
        let end = run(friction, -500.0, 60.0, 0.3, 1);
        let (stop, back) = (60.0 / 600.0, 0.2);
        assert!((end.velocity + 400.0 * back).abs() < 1e-9);
        assert!((end.position - (60.0 * stop / 2.0 - 400.0 * back * back / 2.0)).abs() < 1e-9);
    }
}
