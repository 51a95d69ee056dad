//! A Cortex-M4F without a system: vector table, floating-point unit, and the debugger's console
//! (semihosting).

use core::arch::asm;
use core::fmt;

/// After the stack's top, which the linker script puts first: reset, and what may go wrong.
#[used]
#[unsafe(link_section = ".vectors")]
static VECTORS: [unsafe extern "C" fn() -> !; 15] = {
    let mut vectors = [fault as unsafe extern "C" fn() -> !; 15];
    vectors[0] = reset;
    vectors
};

const OPEN: usize = 0x01;
const WRITE: usize = 0x05;
const EXIT_EXTENDED: usize = 0x20;

/// One call of the debugger.
///
/// # Safety
/// `argument` is the address of the operation's block, whose pointers are valid.
unsafe fn call(operation: usize, argument: *const usize) -> usize {
    let result;
    // SAFETY: the debugger reads the block, changes r0 and continues behind the breakpoint.
    unsafe {
        asm!("bkpt #0xAB", inout("r0") operation => result, in("r1") argument, options(nostack));
    }
    result
}

/// The console.
pub(crate) struct Out;

impl fmt::Write for Out {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        // QEMU has no open file at the start: ":tt", opened to append (4), is its standard output.
        // Opened again, it is the same.
        let open = [c":tt".as_ptr() as usize, 4, 3];
        // SAFETY: the blocks are those of SYS_OPEN (name, mode, length) and SYS_WRITE (handle,
        // bytes, length).
        let left = unsafe {
            let handle = call(OPEN, open.as_ptr());
            call(WRITE, [handle, text.as_ptr() as usize, text.len()].as_ptr())
        };
        if left == 0 { Ok(()) } else { Err(fmt::Error) }
    }
}

pub(crate) fn exit(code: usize) -> ! {
    const STOPPED_BY_APPLICATION: usize = 0x2_0026;
    loop {
        // SAFETY: the block of SYS_EXIT_EXTENDED.
        unsafe { call(EXIT_EXTENDED, [STOPPED_BY_APPLICATION, code].as_ptr()) };
    }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn reset() -> ! {
    // SAFETY: the register of a Cortex-M4 that lets everybody use coprocessors 10 and 11, the
    // floating-point unit.
    unsafe {
        let access = 0xE000_ED88 as *mut u32;
        access.write_volatile(access.read_volatile() | 0xF << 20);
        asm!("dsb", "isb");
    }
    crate::main()
}

unsafe extern "C" fn fault() -> ! {
    exit(3)
}
