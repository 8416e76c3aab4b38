//! Surface properties: friction and restitution.

/// Restitution and friction of contacts; zero unless effects set them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Surface {
    /// e: coefficient of restitution, from 0 to 1.
    pub restitution: f64,
    /// mu: coefficient of Coulomb friction.
    pub friction: f64,
}

impl Surface {
    /// Velocity after an impact on a surface with a unit normal: Newton's law of impact along the normal, `v'.n = -e
    /// v.n`, and Coulomb's law along the tangent, `|m dv_t| <= mu m dv_n`. Returns the fraction of the tangential
    /// velocity that is left, or `None` if the vertex does not move inwards.
    ///
    /// Restitution applies to the velocity at the start of the step, if that is smaller: velocity that forces add
    /// within the step is not returned. So resting contact stays at rest, and no impact adds energy.
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
