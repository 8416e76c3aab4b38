//! Memory of a scheme between steps, in [`State::memory`]: a tag of the kind, the step length, a fingerprint of the
//! state, then the numbers of the scheme. So no kind misreads the memory of another, and none continues from a past of
//! another state.

use crate::state::State;

/// Numbers before the scheme's own.
const HEAD: usize = 4;

/// Whether the memory has `count` numbers of the kind with this tag, for this step length and this state.
pub(super) fn is_current(state: &State, tag: f64, h: f64, count: usize) -> bool {
    let [high, low] = fingerprint(state);
    state.memory.len() == HEAD + count && state.memory[..HEAD] == [tag, h, high, low]
}

/// Whether the memory has `count` numbers of the kind with this tag, for any step length and state.
pub(super) fn is_known(state: &State, tag: f64, count: usize) -> bool {
    state.memory.len() == HEAD + count && state.memory[0] == tag
}

/// The numbers of the scheme, resized if necessary.
pub(super) fn open(state: &mut State, tag: f64, h: f64, count: usize) -> &mut [f64] {
    state.memory.resize(HEAD + count, 0.0);
    state.memory[..2].copy_from_slice(&[tag, h]);
    &mut state.memory[HEAD..]
}

/// The numbers of the scheme, after [`open`].
pub(super) fn read(state: &State) -> &[f64] {
    &state.memory[HEAD..]
}

/// The numbers of the scheme, from the memory alone.
pub(super) fn own(memory: &mut [f64]) -> &mut [f64] {
    &mut memory[HEAD..]
}

/// Writes the fingerprint of the present state.
pub(super) fn close(state: &mut State) {
    let fingerprint = fingerprint(state);
    state.memory[2..HEAD].copy_from_slice(&fingerprint);
}

/// Fingerprint of positions and velocities as two integers, which a level file represents exactly.
fn fingerprint(state: &State) -> [f64; 2] {
    let numbers = state.x.iter().chain(&state.v);
    let hash = numbers.fold(0xcbf2_9ce4_8422_2325_u64, |hash, number| {
        (hash ^ number.to_bits()).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29)
    });
    [f64::from((hash >> 32) as u32), f64::from(hash as u32)]
}
