// thread_local, one copy per virtual core. GCC in a shared object asks __tls_get_addr for each
// access (the general dynamic model), Clang's -femulated-tls asks __emutls_get_address; both are
// redirected here, so the address of a thread-local may be published like any other.

#include <algorithm>
#include <cstring>
#include <link.h>
#include <sys/mman.h>

#include "stress/virtual_cores/internal.hpp"

// Memory is known by its address here.
// NOLINTBEGIN(performance-no-int-to-ptr,bugprone-reserved-identifier,readability-identifier-naming)

namespace irt::virtual_cores {

namespace {

// The initial image of a module's thread-local variables.
struct Image {
  std::size_t module;
  const void* bytes = nullptr;
  std::size_t initialised = 0;
  std::size_t size = 0;
  std::size_t alignment = 1;
};

int find_image(dl_phdr_info* info, std::size_t, void* result) {
  Image& image = *static_cast<Image*>(result);
  if (info->dlpi_tls_modid != image.module) return 0;
  for (unsigned i = 0; i < info->dlpi_phnum; ++i) {
    const ElfW(Phdr)& header = info->dlpi_phdr[i];
    if (header.p_type != PT_TLS) continue;
    image.bytes = reinterpret_cast<const void*>(info->dlpi_addr + header.p_vaddr);
    image.initialised = header.p_filesz;
    image.size = header.p_memsz;
    image.alignment = header.p_align;
  }
  return 1;
}

struct Block {
  const void* key;  // a module's number, or an emulated variable
  Image image;
  void* memory;
  bool fresh;  // as initialised for this run of the core
};

struct Exit {
  void (*destructor)(void*);
  void* object;
};

struct Core {
  std::vector<Block> blocks;
  std::vector<Exit> exits;
};

// The first is for code outside of the cores.
Core& core_state(unsigned core) {
  static std::vector<Core> cores(1);
  const std::size_t index = core == host ? 0 : std::size_t{core} + 1;
  if (index >= cores.size()) cores.resize(index + 1);
  return cores[index];
}

// Blocks live as long as the process, at addresses that depend only on the order of first use.
void* carve(std::size_t size, std::size_t alignment) {
  constexpr std::size_t room = std::size_t{1} << 30U;
  static const std::uintptr_t begin = reinterpret_cast<std::uintptr_t>(
      mmap(reinterpret_cast<void*>(0x110000000000), room, PROT_READ | PROT_WRITE,
           MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE | MAP_FIXED_NOREPLACE, -1, 0));
  static std::uintptr_t next = begin;
  next = (next + alignment - 1) / alignment * alignment;
  const std::uintptr_t block = next;
  next += size;
  if (next > begin + room) active->failed("more than a gigabyte of thread_local", nullptr);
  return reinterpret_cast<void*>(block);
}

// The core's block under `key`; `describe` is asked once.
template <class Describe>
void* block_of(const void* key, Describe describe) {
  Core& core = core_state(current_core);
  auto block = std::ranges::find_if(core.blocks, [key](const Block& b) { return b.key == key; });
  if (block == core.blocks.end()) {
    const Image image = describe();
    void* memory = carve(image.size, std::max<std::size_t>(image.alignment, 16));
    block = core.blocks.insert(block, {key, image, memory, false});
  }
  if (!block->fresh) {
    block->fresh = true;
    std::memset(block->memory, 0, block->image.size);
    if (block->image.initialised != 0)
      std::memcpy(block->memory, block->image.bytes, block->image.initialised);
  }
  return block->memory;
}

}  // namespace

int& core_errno() {
  static const char key = 0;
  return *static_cast<int*>(block_of(
      &key, [] { return Image{.module = 0, .size = sizeof(int), .alignment = alignof(int)}; }));
}

void forget_thread_locals(unsigned core) {
  Core& state = core_state(core);
  for (Block& block : state.blocks) block.fresh = false;
  state.exits.clear();
}

std::vector<Range> thread_locals_of(unsigned core) {
  std::vector<Range> result;
  for (const Block& block : core_state(core).blocks)
    if (const auto begin = reinterpret_cast<std::uintptr_t>(block.memory); block.fresh)
      result.push_back({begin, begin + block.image.size});
  return result;
}

void run_thread_exits(unsigned core) {
  while (!core_state(core).exits.empty()) {
    const Exit last = core_state(core).exits.back();
    core_state(core).exits.pop_back();
    last.destructor(last.object);
  }
}

}  // namespace irt::virtual_cores

namespace {

using namespace irt::virtual_cores;

struct TlsIndex {
  std::size_t module;
  std::size_t offset;
};

struct EmulatedVariable {
  std::size_t size;
  std::size_t alignment;
  void* object;
  const void* initial;
};

}  // namespace

IRT_REDIRECTED void* irt_vc___tls_get_addr(const TlsIndex* index) {
  void* block = block_of(reinterpret_cast<const void*>(index->module), [index] {
    Image image{.module = index->module};
    dl_iterate_phdr(find_image, &image);
    return image;
  });
  return static_cast<char*>(block) + index->offset;
}

IRT_REDIRECTED void* irt_vc___emutls_get_address(const EmulatedVariable* variable) {
  return block_of(variable, [variable] {
    return Image{.module = 0,
                 .bytes = variable->initial,
                 .initialised = variable->initial != nullptr ? variable->size : 0,
                 .size = variable->size,
                 .alignment = variable->alignment};
  });
}

IRT_REDIRECTED int* irt_vc___errno_location() {
  return &core_errno();
}

IRT_REDIRECTED int irt_vc___cxa_thread_atexit(void (*destructor)(void*), void* object, void*) {
  core_state(current_core).exits.push_back({destructor, object});
  return 0;
}
// For library/thread_keys.cpp: who is first in the list is called last.
IRT_REDIRECTED void irt_vc_at_end_of_core(void (*function)(void*)) {
  auto& exits = core_state(current_core).exits;
  exits.insert(exits.begin(), {function, nullptr});
}
// NOLINTEND(performance-no-int-to-ptr,bugprone-reserved-identifier,readability-identifier-naming)
