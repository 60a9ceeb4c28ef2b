#include "renderer/frame_buffer/gamma.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "renderer/frame_buffer/gamma.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace irt::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// The first lanes at `linear`, to as many bytes.
template <class Tag>
HWY_INLINE void lanes_to_bytes(Tag d, const float* linear, std::uint8_t* bytes) {
  const hn::Rebind<std::int32_t, Tag> integers;
  const hn::Rebind<std::uint8_t, Tag> results;
  const auto root = hn::Sqrt(hn::Min(hn::LoadU(d, linear), hn::Set(d, 1.0f)));
  const auto scaled = hn::Add(hn::Mul(root, hn::Set(d, 255.0f)), hn::Set(d, 0.5f));
  hn::StoreU(hn::DemoteTo(results, hn::ConvertTo(integers, scaled)), results, bytes);
}

void to_bytes(const float* linear, std::size_t count, std::uint8_t* bytes) {
  const hn::ScalableTag<float> many;
  const std::size_t lanes = hn::Lanes(many);
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) lanes_to_bytes(many, linear + i, bytes + i);
  for (; i < count; ++i) lanes_to_bytes(hn::CappedTag<float, 1>(), linear + i, bytes + i);
}

}  // namespace irt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace irt {

HWY_EXPORT(to_bytes);

void to_bytes(const float* linear, std::size_t count, std::uint8_t* bytes) {
  HWY_DYNAMIC_DISPATCH(to_bytes)(linear, count, bytes);
}

}  // namespace irt
#endif  // HWY_ONCE
