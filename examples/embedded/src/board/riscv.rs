//! Start, counter and stack of a RISC-V. `riscv-rt` starts it.

use riscv::register::mcycle;
use riscv_rt as _;

pub(super) use riscv::asm::delay;

/// Content of memory of the stack that was never used.
pub(super) const PAINT: u32 = 0xcccc_cccc;

/// The counter runs since the reset.
pub(super) fn start_counter() {}

/// Clocks since the reset, modulo 2³².
pub(super) fn ticks() -> u32 {
    mcycle::read() as u32
}

/// Lowest and highest address of the stack.
pub(super) fn stack() -> Option<(*const u32, *const u32)> {
    // From the linker script: the end of the stack, and where it starts.
    unsafe extern "C" {
        static __estack: u32;
        static _stack_start: u32;
    }
    Some((&raw const __estack, &raw const _stack_start))
}

/// Paints the stack below the caller. It has a frame of its own, so the caller's stays as it is.
#[inline(never)]
pub(super) fn paint_stack() {
    /// Bytes below the variable that this frame may take. They are counted as used.
    const FRAME: usize = 128;

    let Some((mut place, _)) = stack() else {
        return;
    };
    let variable = 0_u32;
    let end = (&raw const variable).wrapping_byte_sub(FRAME);
    while place < end {
        // SAFETY: this memory is below the frame of this function, and nothing else is there.
        unsafe { place.cast_mut().write_volatile(PAINT) };
        place = place.wrapping_add(1);
    }
}
