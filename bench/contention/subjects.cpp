#include <algorithm>
#include <array>

#include "bench/contention/job.hpp"
#include "bench/contention/subject.hpp"
#include "bench/contention/type_erased.hpp"

namespace irt::contention {

namespace built_in {
#define IRT_QUEUE(identifier, name) SubjectMaker maker_of_##identifier();
#include "contention_queues.inc"
#undef IRT_QUEUE
}  // namespace built_in

namespace {

struct BuiltIn {
  std::string_view name;
  SubjectMaker (*maker)();
};

constexpr std::array all{
#define IRT_QUEUE(identifier, name) BuiltIn{name, built_in::maker_of_##identifier},
#include "contention_queues.inc"
#undef IRT_QUEUE
};

const BuiltIn* find(std::string_view name) {
  const auto* found = std::ranges::find(all, name, &BuiltIn::name);
  return found == all.end() ? nullptr : found;
}

/// Accepts everything and always has the same to give.
class Nothing {
 public:
  Nothing(unsigned /*workers*/, std::size_t /*capacity*/) {}
  bool push(unsigned /*worker*/, std::uint64_t element) {
    asm volatile("" : : "r"(element));
    return true;
  }
  bool pop(unsigned /*worker*/, std::uint64_t& element) {
    asm volatile("" : "=r"(element));
    return true;
  }
};

}  // namespace

SubjectMaker subject_maker(const QueueRegistry& queues, std::string_view name) {
  if (name == no_queue) return maker_of<Nothing>();
  if (const BuiltIn* built_in = find(name)) return built_in->maker();
  return type_erased_maker(queues.at(name));
}

SubjectMaker type_erased_maker(const QueueEntry& entry) {
  return [&entry](unsigned workers, std::size_t capacity, bool two) -> std::unique_ptr<Subject> {
    return std::make_unique<SubjectOf<AnyWorkQueue<std::uint64_t>>>(
        entry.make_word_queue(workers, capacity),
        two ? entry.make_word_queue(workers, capacity) : nullptr);
  };
}

bool type_erased(std::string_view name) {
  return find(name) == nullptr;
}

}  // namespace irt::contention
