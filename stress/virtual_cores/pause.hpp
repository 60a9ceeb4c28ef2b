/// Included before everything in code for virtual cores: the instruction `pause`, from whatever
/// intrinsic or assembly, becomes a call of the runtime (redirected.cpp) that leaves every register
/// as it was. GCC writes it as `rep nop`. The red zone below the stack pointer is the code's.
///
/// Clang does not send its intrinsics through the assembler, so that there `pause` stays itself.
#pragma once

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
    ".endm\n");
#endif
