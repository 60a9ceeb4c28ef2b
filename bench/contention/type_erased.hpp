/// Any queue under measurement, at a virtual call per operation.
#pragma once

#include "bench/contention/subject.hpp"

namespace irt::contention {

/// The queue of `entry`, which must outlive what is made, through its type-erased face.
SubjectMaker type_erased_maker(const QueueEntry& entry);

}  // namespace irt::contention
