#include "renderer/frame_buffer/quantize.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "renderer/frame_buffer/quantize.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "renderer/frame_buffer/fixed_point.hpp"

HWY_BEFORE_NAMESPACE();
namespace irt::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void quantize(const float* light, std::size_t count, std::uint64_t* integers) {
  const hn::ScalableTag<double> d;
  const hn::RebindToSigned<decltype(d)> di;
  const hn::RebindToUnsigned<decltype(d)> du;
  const hn::Rebind<float, decltype(d)> df;
  const auto zero = hn::Zero(df), most = hn::Set(df, FixedPointSum::max_value);
  const std::size_t lanes = hn::Lanes(d);
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    const auto value = hn::LoadU(df, light + i);
    const auto positive = hn::IfThenElseZero(hn::Gt(value, zero), value);  // a NaN is not
    // The product is exact, being by a power of two.
    const auto scaled = hn::Mul(hn::Min(positive, most), hn::Set(df, FixedPointSum::scale));
    const auto cut = hn::ConvertTo(di, hn::PromoteTo(d, scaled));
    hn::StoreU(hn::BitCast(du, cut), du, integers + i);
  }
  for (; i < count; ++i) integers[i] = FixedPointSum::quantize(light[i]);
}

}  // namespace irt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace irt {

HWY_EXPORT(quantize);

void quantize(const float* light, std::size_t count, std::uint64_t* integers) {
  HWY_DYNAMIC_DISPATCH(quantize)(light, count, integers);
}

}  // namespace irt
#endif  // HWY_ONCE
