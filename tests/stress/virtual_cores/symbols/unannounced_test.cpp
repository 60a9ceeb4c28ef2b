#include "stress/virtual_cores/symbols/unannounced.hpp"

#include <gtest/gtest.h>
#include <string>
#include <vector>

namespace irt::symbols {
namespace {

std::vector<std::string> found(std::vector<std::string> lines, bool results_on_stack = false) {
  for (std::string& line : lines)
    if (!line.ends_with(">:") && !line.starts_with("Dis")) line.insert(0, "    ");
  lines.insert(lines.begin(), "Disassembly of section .text:");
  std::vector<std::string> sections{"  5 .data  00000010  0000000000004000  CONTENTS",
                                    "  6 .rodata  00000010  0000000000003000  CONTENTS"};
  if (results_on_stack) sections.emplace_back("  9 irt_announced 00000001 0000000000000000  X");
  std::vector<std::string> names;
  for (const Unannounced& access : unannounced(lines, sections)) names.push_back(access.name);
  return names;
}
const std::string function = "0000000000001100 <f>:";
const std::string hook = "1110:\tcall   1030 <__tsan_write8@plt>";

TEST(Unannounced, is_what_no_hook_for_its_address_precedes) {
  using Names = std::vector<std::string>;
  EXPECT_EQ(found({function, "1100:\tmov    %rdi,%rbx", hook, "1120:\tmov    %rax,(%rbx)"}),
            Names{});
  EXPECT_EQ(found({function, "1100:\tmov    %rdi,%rbx", "1120:\tmov    %rax,(%rbx)"}),
            Names{"mov"});
  // Another place, and more than was announced.
  EXPECT_EQ(found({function, "1100:\tmov    %rdi,%rbx", hook, "1120:\tmov    %rax,0x8(%rbx)"}),
            Names{"mov"});
  EXPECT_EQ(found({function, "1100:\tmov    %rdi,%rbx", hook, "1120:\tmovups %xmm0,(%rbx)"}),
            Names{"movups"});
  // A call comes between: place = f(x).
  EXPECT_EQ(found({function, "1100:\tmov    %rdi,%rbx", hook, "1115:\tcall   1040 <g@plt>",
                   "1120:\tmov    %rax,(%rbx)"}),
            Names{"mov"});
  // What stands behind a call that never returns is reached from elsewhere.
  EXPECT_EQ(found({function, "1100:\tmov    %rdi,%rbx", hook, "1115:\ttest   %r12,%r12",
                   "1118:\tje     1130 <f+0x30>", "111a:\tcall   1040 <__cxa_throw@plt>",
                   "1120:\tnopw   0x0(%rax,%rax,1)", "1130:\tmov    %rax,(%rbx)"}),
            Names{});
  // An instruction that the runtime takes over looks like one; the clock is no call to a compiler.
  for (const std::string instruction : {"clock", "pause", "random"}) {
    const std::string stands_in = "1115:\tcall   1040 <irt_vc_cpu_" + instruction + "@plt>";
    EXPECT_EQ(
        found({function, "1100:\tmov    %rdi,%rbx", hook, stands_in, "1120:\tmov    %rax,(%rbx)"}),
        Names{})
        << instruction;
    EXPECT_EQ(found({function, "1100:\tmov    %rdi,%rbx", hook, stands_in,
                     "1120:\tmov    %rax,0x8(%rbx)"}),
              Names{"mov"})
        << instruction;
  }
  // A read is announced, a write follows.
  EXPECT_EQ(found({function, "1100:\tmov    %rdi,%rbx", "1110:\tcall   1030 <__tsan_read8@plt>",
                   "1120:\tmov    %rax,(%rbx)"}),
            Names{"mov"});
  // The stack, a constant, and a global variable.
  EXPECT_EQ(found({function, "1100:\tlea    0x10(%rsp),%rbx", "1120:\tmov    %rax,(%rbx)"}),
            Names{});
  EXPECT_EQ(found({function, "1100:\tmov    0xf00(%rip),%rax        # 2000 <x>"}), Names{});
  EXPECT_EQ(found({function, "1100:\tmov    0xf00(%rip),%rax        # 4008 <x>"}), Names{"mov"});
  // An element of a table of constants, of a table that may change, and a write.
  EXPECT_EQ(found({function, "1100:\tlea    0x1f00(%rip),%rdx        # 3000 <x>",
                   "1108:\tmov    (%rdx,%rax,4),%ebx"}),
            Names{});
  EXPECT_EQ(found({function, "1100:\tlea    0x2f00(%rip),%rdx        # 4000 <x>",
                   "1108:\tmov    (%rdx,%rax,4),%ebx"}),
            Names{"mov"});
  EXPECT_EQ(found({function, "1100:\tlea    0x1f00(%rip),%rdx        # 3000 <x>",
                   "1108:\tmov    %ebx,(%rdx,%rax,4)"}),
            Names{"mov"});
  // The pointer is kept on the stack.
  EXPECT_EQ(found({function, "1100:\tmov    %rdi,-0x8(%rsp)", hook, "1115:\tmov    -0x8(%rsp),%rcx",
                   "1120:\tmov    %rax,(%rcx)"}),
            Names{});
}

TEST(Unannounced, follows_loops_and_leaves_large_results_to_the_caller) {
  using Names = std::vector<std::string>;
  const std::vector<std::string> loop{function,
                                      "1100:\tmov    %rdi,%rbx",
                                      "1108:\tmov    %rbx,%rdi",
                                      hook,
                                      "1115:\tmovq   $0x0,(%rbx)",
                                      "1120:\tadd    $0x8,%rbx",
                                      "1124:\tcmp    %r12,%rbx",
                                      "1128:\tjne    1108 <f+0x8>",
                                      "112a:\tmovq   $0x0,(%rbx)",
                                      "1130:\tret"};
  EXPECT_EQ(found(loop), Names{"movq"});
  // Another place in each round, announced before the paths part.
  EXPECT_EQ(found({function, "1100:\tmov    %rdi,%rbx", "1108:\tmov    %rbx,%rdi", hook,
                   "1115:\ttest   %r12,%r12", "1118:\tje     1130 <f+0x30>",
                   "111a:\tmov    %r13,(%rbx)", "1120:\tret", "1130:\tmov    %r14,(%rbx)",
                   "1138:\tmov    -0x8(%rsp),%rbx", "1140:\tjmp    1108 <f+0x8>"}),
            Names{});
  const std::vector<std::string> result{function, "1100:\tmov    %rdi,%rax",
                                        "1103:\tmovups %xmm0,(%rdi)", "1106:\tret"};
  EXPECT_EQ(found(result), Names{"movups"});
  EXPECT_EQ(found(result, true), Names{});
}

}  // namespace
}  // namespace irt::symbols
