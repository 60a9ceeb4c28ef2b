#include "bench/contention/named_events.hpp"

#include <array>
#include <fmt/format.h>
#include <linux/perf_event.h>
#include <perfmon/pfmlib_perf_event.h>

namespace irt::contention {
namespace {

constexpr std::array l1_misses{
    "MEM_LOAD_RETIRED:L1_MISS", "MEM_LOAD_UOPS_RETIRED:L1_MISS",
    "ANY_DATA_CACHE_FILLS_FROM_SYSTEM:LCL_L2:LOCAL_CCX:NEAR_CACHE_NEAR_FAR:DRAM_IO_NEAR:"
    "FAR_CACHE_NEAR_FAR:DRAM_IO_FAR",
    "ANY_DATA_CACHE_FILLS_FROM_SYSTEM:LCL_L2:INT_CACHE:EXT_CACHE_LCL:MEM_IO_LCL:EXT_CACHE_RMT:"
    "MEM_IO_RMT",
    "DATA_CACHE_REFILLS_FROM_SYSTEM:MABRESP_LCL_L2:LS_MABRESP_LCL_CACHE:LS_MABRESP_LCL_DRAM:"
    "LS_MABRESP_RMT_CACHE:LS_MABRESP_RMT_DRAM"};
constexpr std::array l2_misses{"MEM_LOAD_RETIRED:L2_MISS", "MEM_LOAD_UOPS_RETIRED:L2_MISS",
                               "CORE_TO_L2_CACHEABLE_REQUEST_ACCESS_STATUS:LS_RD_BLK_C"};
constexpr std::array l3_misses{"MEM_LOAD_RETIRED:L3_MISS", "MEM_LOAD_UOPS_RETIRED:L3_MISS",
                               "ANY_DATA_CACHE_FILLS_FROM_SYSTEM:NEAR_CACHE_NEAR_FAR:DRAM_IO_NEAR:"
                               "FAR_CACHE_NEAR_FAR:DRAM_IO_FAR",
                               "ANY_DATA_CACHE_FILLS_FROM_SYSTEM:EXT_CACHE_LCL:MEM_IO_LCL:"
                               "EXT_CACHE_RMT:MEM_IO_RMT"};
// The newest call a line that another core had changed, and gave away, forwarded.
constexpr std::array hitm{"MEM_LOAD_L3_HIT_RETIRED:XSNP_FWD", "MEM_LOAD_L3_HIT_RETIRED:XSNP_HITM",
                          "MEM_LOAD_UOPS_L3_HIT_RETIRED:XSNP_HITM",
                          "MEM_LOAD_UOPS_LLC_HIT_RETIRED:XSNP_HITM",
                          "MEM_UNCORE_RETIRED:OTHER_CORE_L2_HITM"};
constexpr std::array remote_hitm{"MEM_LOAD_L3_MISS_RETIRED:REMOTE_HITM",
                                 "MEM_LOAD_UOPS_L3_MISS_RETIRED:REMOTE_HITM",
                                 "MEM_LOAD_UOPS_LLC_MISS_RETIRED:REMOTE_HITM"};
// What AMD has instead: lines that came from a cache beyond the own L3.
constexpr std::array other_ccx_fills{
    "ANY_DATA_CACHE_FILLS_FROM_SYSTEM:NEAR_CACHE_NEAR_FAR:FAR_CACHE_NEAR_FAR",
    "ANY_DATA_CACHE_FILLS_FROM_SYSTEM:EXT_CACHE_LCL:EXT_CACHE_RMT",
    "DATA_CACHE_REFILLS_FROM_SYSTEM:LS_MABRESP_RMT_CACHE"};

constexpr std::array events_by_family{
    NamedEvent{"l1_misses", l1_misses},     NamedEvent{"l2_misses", l2_misses},
    NamedEvent{"l3_misses", l3_misses},     NamedEvent{"hitm", hitm},
    NamedEvent{"remote_hitm", remote_hitm}, NamedEvent{"other_ccx_fills", other_ccx_fills},
};

}  // namespace

std::span<const NamedEvent> named_events() {
  return events_by_family;
}

std::optional<HardwareEvent> encode(const NamedEvent& event, const std::string& pmu) {
  if (pfm_initialize() != PFM_SUCCESS) return std::nullopt;
  for (const std::string name : event.names) {
    perf_event_attr attributes{};
    pfm_perf_encode_arg_t wanted{};
    wanted.size = sizeof wanted;
    wanted.attr = &attributes;
    const std::string full = pmu.empty() ? name : fmt::format("{}::{}", pmu, name);
    if (pfm_get_os_event_encoding(full.c_str(), PFM_PLM3, PFM_OS_PERF_EVENT, &wanted) ==
        PFM_SUCCESS) {
      return HardwareEvent{event.figure, attributes.type, attributes.config};
    }
  }
  return std::nullopt;
}

EventsByName events_by_name() {
  EventsByName found;
  for (const NamedEvent& event : named_events()) {
    if (const auto one = encode(event)) found.events.push_back(*one);
  }
  if (found.events.empty()) {
    found.missing =
        "hardware counters: L1, L2, L3 misses and HITM are not counted, libpfm knows "
        "no such events of this processor";
  }
  return found;
}

}  // namespace irt::contention
