/// Included before everything in code for virtual cores, where the code is what is shipped but for
/// what follows.
///
/// The instructions `pause`, `rdtsc`, `rdtscp`, `rdrand` and `rdseed`, from whatever intrinsic or
/// assembly, become calls of the runtime (redirected.cpp) that leave every other register as it
/// was; clocks and chance are the tenant's. GCC writes `pause` as `rep nop`. The red zone below the
/// stack pointer is the code's. Clang does not send its intrinsics through the assembler, so that
/// there they stay themselves.
///
/// Nothing says that the thread sanitizer is on: libraries choose other code by that, also the C++
/// library (`shared_ptr`). GCC's macro is undefined on the command line; Clang is asked by
/// `__has_feature`, which answers here as `__has_extension` does for everything else.
/// Templates that the C++ library has in compiled code are compiled again, for what they do to
/// memory to be seen.
///
/// A section says that the plug-in announcer.cpp was there: results of calls are on stacks then.
#pragma once

// Before the C++ library asks whether the sanitizer is on.
#if !defined(__clang__)
asm(".macro pause\n"
    "  leaq -128(%rsp), %rsp\n"
    "  call irt_vc_cpu_pause@PLT\n"
    "  leaq 128(%rsp), %rsp\n"
    ".endm\n"
    ".macro rep operation:vararg\n"
    "  .ifc \\operation,nop\n"
    "    pause\n"
    "  .else\n"
    "    .byte 0xf3\n"
    "    \\operation\n"
    "  .endif\n"
    ".endm\n"
    ".macro rdtscp\n"
    "  leaq -128(%rsp), %rsp\n"
    "  call irt_vc_cpu_clock@PLT\n"
    "  leaq 128(%rsp), %rsp\n"
    ".endm\n"
    ".macro rdtsc\n"
    "  leaq -136(%rsp), %rsp\n"
    "  movq %rcx, (%rsp)\n"
    "  call irt_vc_cpu_clock@PLT\n"
    "  movq (%rsp), %rcx\n"
    "  leaq 136(%rsp), %rsp\n"
    ".endm\n"
    ".macro rdrand register\n"
    "  leaq -136(%rsp), %rsp\n"
    "  call irt_vc_cpu_random@PLT\n"
    "  mov (%rsp), \\register\n"
    "  leaq 136(%rsp), %rsp\n"
    "  stc\n"  // there was a number
    ".endm\n"
    ".macro rdseed register\n"
    "  rdrand \\register\n"
    ".endm\n");
#else
#pragma clang diagnostic push
#pragma clang diagnostic ignored "-Wbuiltin-macro-redefined"
// NOLINTNEXTLINE(bugprone-reserved-identifier,readability-identifier-naming)
#define __has_feature(feature) IRT_VC_SECOND(IRT_VC_NO_##feature, __has_extension(feature), 0)
#pragma clang diagnostic pop
#define IRT_VC_SECOND(...) IRT_VC_SECOND_OF(__VA_ARGS__)
#define IRT_VC_SECOND_OF(first, second, ...) second
#define IRT_VC_NO_thread_sanitizer 0, 0
// NOLINTNEXTLINE(bugprone-reserved-identifier)
#define IRT_VC_NO___thread_sanitizer__ 0, 0
#endif

#if defined(__cplusplus)
#include <bits/c++config.h>
#undef _GLIBCXX_EXTERN_TEMPLATE
// NOLINTNEXTLINE(bugprone-reserved-identifier,readability-identifier-naming)
#define _GLIBCXX_EXTERN_TEMPLATE 0
#endif

#if defined(IRT_VC_ANNOUNCER)
asm(".pushsection irt_announced,\"\",@progbits\n.byte 1\n.popsection\n");
#endif
