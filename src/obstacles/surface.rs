//! Surface properties: friction and restitution.

/// What touching does to velocities: nothing but stopping them, unless effects say more.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Surface {
    /// e: the share of the approach velocity that is given back, from 0 to 1.
    pub restitution: f64,
    /// mu: the greatest tangential impulse as a share of the normal one.
    pub friction: f64,
}

impl Surface {
    /// The velocity after touching a surface with a unit normal: Newton's law of impact across it, `v'.n = -e v.n`, and
    /// Coulomb's law along it, `|m dv_t| <= mu m dv_n`. Returns the share of the tangential velocity that is left, or `None`
    /// if the vertex does not move inwards.
    ///
    /// What is given back is measured by the velocity at the beginning of the step, if that is smaller: what forces added
    /// within the step is not returned, so that what rests comes to rest, and no bounce gains energy.
    #[inline]
    pub fn impact_response(self, [nx, ny]: [f64; 2], before: [f64; 2], v: &mut [f64; 2]) -> Option<f64> {
        let across = v[0] * nx + v[1] * ny;
        if across >= 0.0 || across.is_nan() {
            return None;
        }
        let push = -across - self.restitution * (before[0] * nx + before[1] * ny).clamp(across, 0.0);
        let kept = if self.friction == 0.0 {
            1.0
        } else {
            let (tx, ty) = (v[0] - across * nx, v[1] - across * ny);
            let sliding = (tx * tx + ty * ty).sqrt();
            let kept = if sliding > self.friction * push { 1.0 - self.friction * push / sliding } else { 0.0 };
            *v = [across * nx + kept * tx, across * ny + kept * ty];
            kept
        };
        v[0] += push * nx;
        v[1] += push * ny;
        Some(kept)
    }
}
