/// The queues under measurement, by name.
#pragma once

#include <string_view>

#include "bench/contention/subject.hpp"
#include "queues/registry.hpp"

namespace irt::contention {

/// The queue `name` of `queues`, or `no_queue`. One of the tree, or of a plug-in with a contention
/// module, is measured by its concrete type; another one through its type-erased face, at a virtual
/// call per operation. Throws RegistryError for a module of another version.
SubjectMaker subject_maker(const QueueRegistry& queues, std::string_view name);

/// Whether the queue `name` is measured through its type-erased face.
bool type_erased(const QueueRegistry& queues, std::string_view name);

/// The queue of `entry`, which must outlive what is made, through its type-erased face.
SubjectMaker type_erased_maker(const QueueEntry& entry);

}  // namespace irt::contention
