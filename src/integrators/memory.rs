//! What a scheme remembers between steps, in [`State::memory`]: a mark of the kind, the step length, and a fingerprint of
//! the state it belongs to, then the scheme's own numbers. So no kind misreads what another one left, and none goes on
//! from a past that the present state did not come from.

use crate::state::State;

/// Numbers before the scheme's own.
const HEAD: usize = 4;

/// Whether `count` numbers are remembered by the kind with this mark, for this step length and this state.
pub(super) fn is_current(state: &State, tag: f64, h: f64, count: usize) -> bool {
    let [high, low] = fingerprint(state);
    state.memory.len() == HEAD + count && state.memory[..HEAD] == [tag, h, high, low]
}

/// Whether `count` numbers are remembered by the kind with this mark, for whatever step length and state.
pub(super) fn is_known(state: &State, tag: f64, count: usize) -> bool {
    state.memory.len() == HEAD + count && state.memory[0] == tag
}

/// The scheme's own numbers, to read and to write; made room for if need be.
pub(super) fn open(state: &mut State, tag: f64, h: f64, count: usize) -> &mut [f64] {
    state.memory.resize(HEAD + count, 0.0);
    state.memory[..2].copy_from_slice(&[tag, h]);
    &mut state.memory[HEAD..]
}

/// The scheme's own numbers, after [`open`].
pub(super) fn read(state: &State) -> &[f64] {
    &state.memory[HEAD..]
}

/// The same, of the memory alone.
pub(super) fn own(memory: &mut [f64]) -> &mut [f64] {
    &mut memory[HEAD..]
}

/// Ties what is remembered to the state as it is now.
pub(super) fn close(state: &mut State) {
    let fingerprint = fingerprint(state);
    state.memory[2..HEAD].copy_from_slice(&fingerprint);
}

/// A fingerprint of positions and velocities as two whole numbers, which a level file holds exactly.
fn fingerprint(state: &State) -> [f64; 2] {
    let numbers = state.x.iter().chain(&state.v);
    let hash = numbers.fold(0xcbf2_9ce4_8422_2325_u64, |hash, number| {
        (hash ^ number.to_bits()).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29)
    });
    [f64::from((hash >> 32) as u32), f64::from(hash as u32)]
}
