#include "bench/contention/subjects.hpp"

#include <algorithm>
#include <array>
#include <dlfcn.h>
#include <map>
#include <string>

#include "bench/contention/job.hpp"

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

/// By the queue's name, which is that of its file.
std::map<std::string, SubjectMaker, std::less<>>& modules() {
  static std::map<std::string, SubjectMaker, std::less<>> opened;
  return opened;
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

void open_subject_module(const std::filesystem::path& plugin) {
  std::filesystem::path file = std::filesystem::absolute(plugin);
  file.replace_extension(".contention.so");
  if (!std::filesystem::exists(file)) return;
  // Stays open: its code is in use until the process ends.
  void* object = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (object == nullptr) throw RegistryError(std::string(dlerror()));
  const auto* module = static_cast<const SubjectModule*>(dlsym(object, "irt_contention"));
  constexpr SubjectModule own;
  if (module == nullptr || module->abi_version != own.abi_version ||
      module->seat_bytes != own.seat_bytes || module->table_bytes != own.table_bytes)
    throw RegistryError(file.string() + ": built for another version of irt; build it again");
  modules()[plugin.stem()] = module->make;
}

SubjectMaker subject_maker(const QueueRegistry& queues, std::string_view name) {
  if (name == no_queue) return maker_of<Nothing>();
  if (const BuiltIn* built_in = find(name)) return built_in->maker();
  if (const auto module = modules().find(name); module != modules().end()) return module->second;
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
  return find(name) == nullptr && !modules().contains(name);
}

}  // namespace irt::contention
