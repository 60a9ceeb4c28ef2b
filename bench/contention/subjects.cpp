#include "bench/contention/subjects.hpp"

#include <filesystem>
#include <string>

#include "bench/contention/job.hpp"

namespace irt::contention {

namespace {

SubjectMaker open_module(const std::filesystem::path& file) {
  const auto* module = static_cast<const SubjectModule*>(symbol_of(file, "irt_contention"));
  constexpr SubjectModule own;
  if (module == nullptr || module->abi_version != own.abi_version ||
      module->seat_bytes != own.seat_bytes || module->table_bytes != own.table_bytes)
    throw RegistryError(file.string() + ": built for another version of irt; build it again");
  return module->make;
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
  return type_erased(queues, name) ? type_erased_maker(queues.at(name))
                                   : open_module(queues.module(name, ModuleKind::contention));
}

SubjectMaker type_erased_maker(const QueueEntry& entry) {
  return [&entry](unsigned workers, std::size_t capacity, bool two) -> std::unique_ptr<Subject> {
    return std::make_unique<SubjectOf<AnyWorkQueue<std::uint64_t>>>(
        entry.make_word_queue(workers, capacity),
        two ? entry.make_word_queue(workers, capacity) : nullptr);
  };
}

bool type_erased(const QueueRegistry& queues, std::string_view name) {
  return !queues.has(name, ModuleKind::contention);
}

}  // namespace irt::contention
