#include "stress/virtual_cores/symbols/evaluation.hpp"

#include <algorithm>

namespace irt::symbols {

namespace {

bool contain(const std::vector<Section>& sections, std::int64_t address) {
  return std::ranges::any_of(sections, [address](const Section& section) {
    return static_cast<std::uint64_t>(address) >= section.begin &&
           static_cast<std::uint64_t>(address) < section.end;
  });
}

}  // namespace

bool Sections::may_change(std::int64_t address) const {
  return contain(writable, address);
}
bool Sections::never_changes(std::int64_t address) const {
  return contain(constants, address);
}

void Evaluation::step(Frame& frame, const Instruction& at) {
  if (at.is("push")) {
    const NamedValue value = read(frame, at.operands[0], at);
    frame.in[rsp].offset -= 8;
    if (frame.in[rsp].root == stack_root) frame.slots[frame.in[rsp].offset] = value;
    return;
  }
  if (at.is("pop") && at.operands.size() == 1) {
    static const Operand top{.kind = Operand::Kind::memory, .base = rsp};
    write(frame, at.operands[0], read(frame, top, at), at);
    frame.in[rsp].offset += 8;
    return;
  }
  if (at.is("leave")) {
    static const Operand top{.kind = Operand::Kind::memory, .base = rsp};
    frame.in[rsp] = frame.in[rbp];
    frame.in[rbp] = read(frame, top, at);
    frame.in[rsp].offset += 8;
    return;
  }
  compute(frame, at);
}

void Evaluation::call(Frame& frame, const Instruction& at) {
  for (std::uint8_t r = 0; r < 12; ++r)
    if (r != rbx && r != rsp && r != rbp)
      frame.in[r] = names_.of("after", {0, static_cast<std::int64_t>(at.address)}, {}, r);
}

void Evaluation::single(Frame& frame, const Instruction& at) {
  for (const std::uint8_t r : {rax, rcx, rdx})
    frame.in[r] = names_.of("after", {0, static_cast<std::int64_t>(at.address)}, {}, r);
}

NamedValue Evaluation::address_of(const Frame& frame, const Operand& operand) {
  if (operand.absolute) return {0, operand.offset};
  NamedValue value{0, operand.offset};
  if (operand.base != no_register) value = sum(frame.in[operand.base], value);
  if (operand.index == no_register) return value;
  const NamedValue index = frame.in[operand.index];
  if (index.root == 0) return {value.root, value.offset + index.offset * operand.scale};
  const NamedValue scaled =
      operand.scale == 1 ? index : names_.of("scale", {index.root, 0}, {}, operand.scale);
  const NamedValue far = sum({value.root, 0}, {scaled.root, 0});
  return {far.root, far.offset + value.offset + index.offset * operand.scale};
}

NamedValue Evaluation::sum(NamedValue a, NamedValue b) {
  if (a.root == 0) return {b.root, b.offset + a.offset};
  if (b.root == 0) return {a.root, a.offset + b.offset};
  const NamedValue root =
      names_.of("+", {std::min(a.root, b.root), 0}, {std::max(a.root, b.root), 0}, 0,
                names_.on_stack(a) || names_.on_stack(b));
  return {root.root, a.offset + b.offset};
}

NamedValue Evaluation::read(Frame& frame, const Operand& operand, const Instruction& at) {
  if (operand.kind == Operand::Kind::immediate) return {0, operand.offset};
  if (operand.kind == Operand::Kind::reg && operand.base != no_register)
    return frame.in[operand.base];
  const NamedValue own = names_.of("at", {0, static_cast<std::int64_t>(at.address)});
  if (operand.kind != Operand::Kind::memory || operand.segment) return own;
  const NamedValue place = address_of(frame, operand);
  if (place.root == 0)
    return sections_.may_change(place.offset) ? own : names_.of("constant", place);
  if (place.root != stack_root) return own;
  return frame.slots.try_emplace(place.offset, own).first->second;
}

void Evaluation::write(Frame& frame, const Operand& operand, NamedValue value,
                       const Instruction& at) {
  if (operand.kind == Operand::Kind::reg) {
    if (operand.base != no_register) frame.in[operand.base] = value;
    return;
  }
  if (operand.kind != Operand::Kind::memory || operand.segment) return;
  const NamedValue place = address_of(frame, operand);
  if (place.root != stack_root) return;
  // Up to 16 bytes are written; what is narrower than 8 is no value that anybody asks for.
  const bool whole = at.name == "mov" || at.name == "movq";
  const std::int64_t end = place.offset + (whole ? 8 : 16);
  for (auto slot = frame.slots.lower_bound(place.offset - 7);
       slot != frame.slots.end() && slot->first < end; ++slot)
    slot->second = names_.of("part", {0, static_cast<std::int64_t>(at.address)}, {}, slot->first);
  frame.slots[place.offset] = value;
}

void Evaluation::compute(Frame& frame, const Instruction& at) {
  const NamedValue own = names_.of("at", {0, static_cast<std::int64_t>(at.address)});
  if (at.is("cltq") || at.is("cwtl")) {
    frame.in[rax] = names_.of(at.name, frame.in[rax]);
  } else if (at.is("cqto") || at.is("cltd")) {
    frame.in[rdx] = names_.of(at.name, frame.in[rax]);
  } else if (at.is("rep") || at.is("cpuid") || at.is("rdtsc") || at.is("syscall") ||
             at.is("xgetbv")) {
    for (const std::uint8_t r : {rax, rcx, rdx, rsi, rdi})
      frame.in[r] = names_.of("after", own, {}, r, names_.on_stack(frame.in[r]));
  } else if (at.operands.size() == 1 &&
             (at.is("mul") || at.is("imul") || at.is("div") || at.is("idiv"))) {
    frame.in[rax] = names_.of("after", own, {}, rax);
    frame.in[rdx] = names_.of("after", own, {}, rdx);
  }
  if (at.operands.empty() || at.only_reads() || at.is("lock") || at.is("nop")) return;
  const Operand& to = at.operands.back();
  if (at.is("xchg") && at.operands.size() == 2) {
    const NamedValue a = read(frame, at.operands[0], at);
    const NamedValue b = read(frame, at.operands[1], at);
    write(frame, at.operands[0], b, at);
    write(frame, at.operands[1], a, at);
    return;
  }
  write(frame, to, result_of(frame, at, own), at);
}

NamedValue Evaluation::result_of(Frame& frame, const Instruction& at, NamedValue own) {
  const Operand& from = at.operands.front();
  const Operand& to = at.operands.back();
  const bool wide = to.kind == Operand::Kind::memory || to.bytes == 8;
  if (at.is("lea")) return wide ? address_of(frame, from) : own;
  const bool moves =
      at.name == "mov" || at.name == "movq" || at.name == "movabs" || at.name == "movl";
  if (moves && (from.kind == Operand::Kind::immediate || (wide && from.bytes != 4)))
    return from.kind == Operand::Kind::reg && from.base == no_register ? own
                                                                       : read(frame, from, at);
  if (at.is("xor") && at.operands.size() == 2 && from.kind == Operand::Kind::reg &&
      from.base == to.base)
    return {0, 0};
  if (to.kind == Operand::Kind::memory) return own;
  if (at.is("set") || at.operands.size() > 2) return own;
  const NamedValue a = at.operands.size() == 2 ? read(frame, from, at) : NamedValue{};
  const NamedValue b = read(frame, to, at);
  if (wide && at.is("add")) return sum(a, b);
  if (wide && at.is("sub") && a.root == 0) return {b.root, b.offset - a.offset};
  if (wide && at.is("inc")) return {b.root, b.offset + 1};
  if (wide && at.is("dec")) return {b.root, b.offset - 1};
  const bool copies = at.is("mov") || at.is("movz") || at.is("movs") || at.is("cvt");
  const bool keeps_stack = (at.is("and") && wide && names_.on_stack(b)) ||
                           (at.is("cmov") && names_.on_stack(a) && names_.on_stack(b)) ||
                           (at.is("sub") && wide && names_.on_stack(b) && !names_.on_stack(a));
  return names_.of(at.name, a, copies ? NamedValue{} : b, from.bytes * 16 + to.bytes, keeps_stack);
}

}  // namespace irt::symbols
