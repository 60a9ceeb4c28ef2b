#include "renderer/frame_buffer/frame_buffer.hpp"

#include <algorithm>
#include <array>

#include "renderer/frame_buffer/atomic_float.hpp"
#include "renderer/frame_buffer/fixed_point.hpp"
#include "renderer/frame_buffer/gamma.hpp"
#include "renderer/frame_buffer/private_sums.hpp"
#include "renderer/frame_buffer/spinlock.hpp"

namespace irt {
namespace {

template <class Buffer>
std::unique_ptr<FrameBuffer> make(std::uint32_t width, std::uint32_t height) {
  return std::make_unique<Buffer>(width, height);
}

constexpr std::array entries{
    FrameBufferEntry{"private-sums", "integers per thread: nothing shared, the same bits always",
                     true, make<PrivateSumsFrameBuffer>},
    FrameBufferEntry{"fixed-point", "integer fetch-and-add: wait-free, the same bits in any order",
                     true, make<FixedPointFrameBuffer>},
    FrameBufferEntry{"atomic-float", "compare-and-swap on floats: lock-free", false,
                     make<AtomicFloatFrameBuffer>},
    FrameBufferEntry{"spinlock", "floats behind one spinlock, the thesis' (3.2)", false,
                     make<SpinlockFrameBuffer>},
};

}  // namespace

std::span<const FrameBufferEntry> frame_buffers() {
  return entries;
}

std::uint64_t fnv1a(std::span<const std::uint8_t> bytes, std::uint64_t state) {
  for (const std::uint8_t byte : bytes) state = (state ^ byte) * 0x100'0000'01b3u;
  return state;
}

Image FrameBuffer::image() const {
  Image image{width_, height_, std::vector<std::uint8_t>(std::size_t{pixels()} * 3)};
  constexpr std::uint32_t at_once = 64;
  for (std::uint32_t first = 0; first < pixels(); first += at_once) {
    const std::uint32_t count = std::min(at_once, pixels() - first);
    alignas(64) float linear[3 * at_once];
    sums(first, count, linear);
    to_bytes(linear, std::size_t{3} * count, &image.rgb[std::size_t{3} * first]);
  }
  return image;
}

std::uint64_t FrameBuffer::hash() const {
  return fnv1a(image().rgb);
}

std::uint64_t ExactFrameBuffer::hash() const {
  std::uint64_t state = fnv1a({});
  for (std::uint32_t first = 0; first < pixels(); first += at_once) {
    FixedPointSum some[at_once];
    const std::uint32_t count = std::min(at_once, pixels() - first);
    fetch(first, count, some);
    for (std::uint32_t i = 0; i < count; ++i) {
      for (const std::uint64_t value : {some[i].red, some[i].green, some[i].blue}) {
        std::array<std::uint8_t, 8> bytes{};
        for (std::size_t k = 0; k < bytes.size(); ++k) {
          bytes[k] = static_cast<std::uint8_t>(value >> (8 * k));
        }
        state = fnv1a(bytes, state);
      }
    }
  }
  return state;
}

}  // namespace irt
