/// In whose code an interrupted thread stands.
///
/// A queue's claims are about the queue's code. Whoever stops a thread inside the loader, the
/// allocator or the C++ runtime stops it with their locks held, and everybody who allocates, throws
/// or uses a thread-local for the first time waits for those. Which frames are whose is decided by
/// the object they are mapped from: the loader, the C library, the C++ library, the unwinder and
/// the kernel's vdso are machinery, all else is the queue's, its libraries included.
#pragma once

#include "stress/threads/slot.hpp"

namespace irt::stress {

/// Looks up what is machinery on this system. Once per process, before any thread is interrupted;
/// objects loaded later count as the queue's.
void know_machinery();

/// For signal handlers: where the thread that was interrupted stands in the method it entered with
/// the stack at `base` (`Slot::base`; null: in none), and the frames of that method in `trace`,
/// innermost first. Without a base, all frames.
Standing where_interrupted(const void* base, Trace& trace);

/// The stack pointer of the caller, for `Slot::base`: whatever it calls next stands deeper.
const void* own_stack_pointer();

}  // namespace irt::stress
