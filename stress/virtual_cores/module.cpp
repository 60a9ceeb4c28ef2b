#include <algorithm>
#include <cstring>
#include <cxxabi.h>
#include <dlfcn.h>
#include <elf.h>
#include <filesystem>
#include <fstream>
#include <link.h>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <unistd.h>
#include <unordered_map>

#include "stress/virtual_cores/harmless.hpp"
#include "stress/virtual_cores/internal.hpp"

// Memory is known by its address here.
// NOLINTBEGIN(performance-no-int-to-ptr)

namespace irt::virtual_cores {

namespace {

// The module's variables that live in memory it may write after loading: .data and .bss, without
// what the loader has made read-only.
using Globals = Range;

int find_globals(dl_phdr_info* info, std::size_t, void* result) {
  auto& [offset, globals] = *static_cast<std::pair<std::uintptr_t, Globals>*>(result);
  if (info->dlpi_addr != offset) return 0;
  std::uintptr_t read_only_end = 0;
  for (unsigned i = 0; i < info->dlpi_phnum; ++i) {
    const ElfW(Phdr)& header = info->dlpi_phdr[i];
    const std::uintptr_t begin = offset + header.p_vaddr;
    const Range range{begin, begin + header.p_memsz};
    if (header.p_type == PT_LOAD && (header.p_flags & PF_X) != 0) add_code(range);
    if (header.p_type == PT_LOAD && (header.p_flags & PF_W) == 0) add_constants(range);
    if (header.p_type == PT_GNU_RELRO) read_only_end = (begin + header.p_memsz + 4095) & ~4095UL;
    if (header.p_type == PT_LOAD && (header.p_flags & PF_W) != 0)
      globals = {begin, begin + header.p_memsz};
  }
  const std::uintptr_t loaded = globals.begin;
  globals.begin = std::min(std::max(globals.begin, read_only_end), globals.end);
  if (globals.begin > loaded) add_constants({loaded, globals.begin});
  return 1;
}

// The variables of the libraries that everybody uses, some of which, as std::cout, the loader puts
// into the host's.
int find_library_data(dl_phdr_info* info, std::size_t, void* result) {
  const std::string_view name = info->dlpi_name;
  if (!name.empty() && name.find("/libstdc++.so") == std::string_view::npos &&
      name.find("/libc.so") == std::string_view::npos)
    return 0;
  for (unsigned i = 0; i < info->dlpi_phnum; ++i) {
    const ElfW(Phdr)& header = info->dlpi_phdr[i];
    if (header.p_type != PT_LOAD || (header.p_flags & PF_W) == 0) continue;
    const std::uintptr_t begin = info->dlpi_addr + header.p_vaddr;
    static_cast<std::vector<Range>*>(result)->push_back({begin, begin + header.p_memsz});
  }
  return 0;
}

// What the code allocates while it runs natively: constructors of global variables while it is
// loaded, and its main where that is no program to explore. It lasts as long as the code, like the
// variables that lead to it, or until the code frees it.
class Native final : public Tenant {
 public:
  Native() : before_(active) { active = this; }
  Native(const Native&) = delete;
  Native& operator=(const Native&) = delete;
  ~Native() override { active = before_; }

  void* allocate(std::size_t size, std::size_t alignment, const void* pc) override {
    void* block = Tenant::allocate(size, alignment, pc);
    if (block != nullptr) blocks_[address_of(block)] = address_of(block) + size;
    return block;
  }
  void release(void* block, const void* pc) override {
    blocks_.erase(address_of(block));
    Tenant::release(block, pc);
  }
  [[nodiscard]] std::vector<Range> blocks() const {
    std::vector<Range> ranges;
    for (const auto& [begin, end] : blocks_) ranges.push_back({begin, end});
    return ranges;
  }

 private:
  Tenant* before_;
  std::unordered_map<std::uintptr_t, std::uintptr_t> blocks_;
};

// Where the loaded file has what irt_virtual_module() has taken from .init_array; empty if nothing.
Range constructors_of(const std::string& path, std::uintptr_t offset) {
  std::ifstream file(path, std::ios::binary);
  const auto read = [&file](std::uint64_t at, void* to, std::size_t bytes) {
    file.seekg(static_cast<std::streamoff>(at));
    file.read(static_cast<char*>(to), static_cast<std::streamsize>(bytes));
  };
  ElfW(Ehdr) header{};
  read(0, &header, sizeof header);
  std::vector<ElfW(Shdr)> sections(header.e_shnum);
  read(header.e_shoff, sections.data(), sections.size() * sizeof sections[0]);
  if (!file || header.e_shstrndx >= sections.size()) return {};
  std::string names(sections[header.e_shstrndx].sh_size, '\0');
  read(sections[header.e_shstrndx].sh_offset, names.data(), names.size());
  for (const ElfW(Shdr) & section : sections)
    if (section.sh_name < names.size() &&
        std::string_view(names.c_str() + section.sh_name) == "irt_init_array")
      return {offset + section.sh_addr, offset + section.sh_addr + section.sh_size};
  return {};
}

}  // namespace

std::string demangled(const char* name) {
  int status = 0;
  const std::unique_ptr<char, void (*)(void*)> text(
      abi::__cxa_demangle(name, nullptr, nullptr, &status), std::free);
  return status == 0 ? text.get() : name;
}

bool is_of_library(std::uintptr_t address) {
  static const std::vector<Range> variables = [] {
    std::vector<Range> found;
    dl_iterate_phdr(find_library_data, &found);
    return found;
  }();
  return std::ranges::any_of(variables, [address](const Range& range) {
    return address >= range.begin && address < range.end;
  });
}

struct Module::State {
  std::string file;
  void* handle = nullptr;
  const link_map* map = nullptr;
  Globals globals{};
  std::optional<Native> native{};
  std::vector<Range> memory{};  // what is put back, in the order of addresses
  std::vector<char> initial{};
  std::vector<Constructor> constructors{};
};

Module::Module(const std::string& file, Constructs when) : state_(new State{.file = file}) {
  state_->native.emplace();
  // A name without a folder would be looked for elsewhere.
  const std::string path = std::filesystem::absolute(file);
  state_->handle = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (state_->handle == nullptr)
    throw std::runtime_error(std::string("virtual cores: ") + dlerror());
  dlinfo(state_->handle, RTLD_DI_LINKMAP, &state_->map);
  const Range constructors = constructors_of(path, state_->map->l_addr);
  for (std::uintptr_t at = constructors.begin; at < constructors.end; at += sizeof(Constructor))
    state_->constructors.push_back(*reinterpret_cast<const Constructor*>(at));
  if (when != Constructs::each_program) {
    for (const Constructor construct : state_->constructors) construct(0, nullptr, environ);
    state_->constructors.clear();
  }
  std::pair<std::uintptr_t, Globals> search{state_->map->l_addr, {}};
  dl_iterate_phdr(find_globals, &search);
  state_->globals = search.second;
  remember_memory();
  if (when != Constructs::with_main) state_->native.reset();
}

Module::~Module() {
  // Destructors of global variables must not see what a tenant's heap held.
  if (!state_->native) reset_globals();
  dlclose(state_->handle);
}

void* Module::find(const std::string& symbol) const {
  void* address = dlsym(state_->handle, symbol.c_str());
  if (address == nullptr)
    throw std::runtime_error("virtual cores: " + state_->file + " exports no \"" + symbol +
                             "\"; make it with irt_virtual_module()");
  return address;
}

void* Module::find_any(const std::vector<std::string>& symbols) const {
  for (const std::string& symbol : symbols)
    if (void* address = dlsym(state_->handle, symbol.c_str())) return address;
  return find(symbols.front());
}

void Module::remember_memory(const std::vector<Range>& others) {
  state_->memory = state_->native->blocks();
  state_->memory.push_back(state_->globals);
  state_->memory.insert(state_->memory.end(), others.begin(), others.end());
  std::ranges::sort(state_->memory, {}, &Range::begin);
  state_->initial = image();
}

void Module::reset_globals() {
  restore(state_->initial);
}

std::vector<char> Module::image() const {
  std::vector<char> bytes;
  for (const Range range : state_->memory)
    bytes.insert(bytes.end(), reinterpret_cast<const char*>(range.begin),
                 reinterpret_cast<const char*>(range.end));
  return bytes;
}

void Module::restore(const std::vector<char>& image) {
  const char* from = image.data();
  for (const Range range : state_->memory) {
    const std::size_t size = range.end - range.begin;
    if (size != 0) std::memcpy(reinterpret_cast<void*>(range.begin), from, size);
    from += size;
  }
}

bool Module::owns_global(std::uintptr_t address) const {
  const auto after = std::ranges::upper_bound(state_->memory, address, {}, &Range::begin);
  return after != state_->memory.begin() && address < std::prev(after)->end;
}

const std::vector<Range>& Module::globals() const {
  return state_->memory;
}

std::vector<std::string> Module::unseen_calls() const {
  const ElfW(Sym)* symbols = nullptr;
  const char* names = nullptr;
  for (const ElfW(Dyn)* entry = state_->map->l_ld; entry->d_tag != DT_NULL; ++entry) {
    if (entry->d_tag == DT_SYMTAB) symbols = reinterpret_cast<const ElfW(Sym)*>(entry->d_un.d_ptr);
    if (entry->d_tag == DT_STRTAB) names = reinterpret_cast<const char*>(entry->d_un.d_ptr);
  }
  std::vector<std::string> result;
  if (symbols == nullptr || names == nullptr) return result;
  // The string table follows the symbol table in every linker's output; there is no other count.
  const std::size_t count =
      static_cast<std::size_t>(names - reinterpret_cast<const char*>(symbols)) / sizeof(ElfW(Sym));
  for (std::size_t i = 1; i < count; ++i) {
    const char* name = names + symbols[i].st_name;
    if (symbols[i].st_shndx == SHN_UNDEF && !is_harmless(name)) result.push_back(demangled(name));
  }
  std::ranges::sort(result);
  return result;
}

const std::vector<Constructor>& Module::constructors() const {
  return state_->constructors;
}

const std::string& Module::file() const {
  return state_->file;
}
std::uintptr_t Module::load_offset() const {
  return state_->map->l_addr;
}

}  // namespace irt::virtual_cores
// NOLINTEND(performance-no-int-to-ptr)
