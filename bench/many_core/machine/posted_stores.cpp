#include "bench/many_core/machine/posted_stores.hpp"

#include <algorithm>

#include "bench/many_core/machine/memory.hpp"

namespace irt::many_core {

PostedStores::PostedStores(const Profile& profile, State& state)
    : state_(state), store_hit_(picoseconds(profile.store_hit)) {}

void PostedStores::post(Thread& me, const PostedStore& store) {
  me.stores.add(store).issued = me.clock;
  if (me.stores.size() == 1) issue(me, me.clock);
}

void PostedStores::issue(Thread& me, Time now) {
  const PostedStore& store = me.stores.first();
  me.store_request = {.issued = store.issued,
                      .pc = store.pc,
                      .bytes = store.bytes,
                      .takes = store_hit_,
                      .thread = me.number,
                      .core = me.core,
                      .want = Want::ownership,
                      .posted = true};
  state_.directory.send(*store.line, me.store_request, now);
}

void PostedStores::commit(Thread& me, Line& line, Time done) {
  const PostedStore& store = me.stores.first();
  if (store.size != 0) write_memory(store.address, store.size, store.value);
  line.written |= store.bytes;
  me.committed = std::max(me.committed, done) + store_hit_;
  line.available = std::max(line.available, me.committed);
  me.stores.drop_first();
  if (!me.stores.empty()) issue(me, line.event.time);
  if (me.crowded || (me.draining && me.stores.empty())) {
    state_.events.push(me.event, std::max(me.committed, me.clock));
    me.crowded = me.draining = false;
  }
}

}  // namespace irt::many_core
