#pragma once
// The JSON shape of interlocks (interlock.hpp): keys, sentences, bounds.

#include "config/codec.hpp"
#include "config/interlock.hpp"

namespace fogbench::config {

constexpr std::array<EnumName<InterlockAction>, 3> enum_names(InterlockAction /*action*/) {
  return {{{"warn", InterlockAction::kWarn},
           {"pause", InterlockAction::kPause},
           {"abort", InterlockAction::kAbort}}};
}

/// The keys of the thresholds carry the unit of the kind, so they are known once the kind is.
template <class Visitor>
void describe(Visitor& v, InterlockCondition& c) {
  const InterlockKindInfo& info = info_of(c.kind);
  v.tag("kind", info.name);
  v.required(info.trip_key, c.trip, info.description, at_least(info.lowest));
  v.required(info.clear_key, c.clear,
             worse_upwards(c.kind) > 0.0
                 ? "At or below it the condition is over; at most the trip."
                 : "At or above it the condition is over; at least the trip.",
             at_least(info.lowest));
  if (watches_channel(c.kind)) v.required("channel", c.channel, "The channel's name.");
  if (c.kind != InterlockKind::kHeaterWithoutEffect) return;
  v.optional("rise_c", c.rise, "So much warmer counts as an effect.", above(0));
  v.optional("near_target_c", c.near_target, "This near to the target none is asked for.",
             above(0));
}

template <>
struct Codec<InterlockCondition> {
  static bool read(const Place& at, InterlockCondition& out, const Rule& rule);
  static ordered_json schema(const Rule& rule);
  static ordered_json write(const InterlockCondition& condition);
};

template <class Visitor>
void describe(Visitor& v, InterlockConfig& i) {
  v.required("name", i.name, "Names it in events and reasons.");
  v.optional("all_of", i.all_of, "Conditions of which all must hold.", not_empty());
  v.optional("any_of", i.any_of, "Instead of all_of: conditions of which one must hold.",
             not_empty());
  v.optional("consecutive", i.consecutive, "How many seconds in a row, before it trips.",
             between(1, 3600));
  v.required("action", i.action, "What is done when it trips: warn, pause, or abort.");
}

bool check(const Place& at, const InterlockConfig& interlock);
/// The parts of a bench's list that have to agree with each other and with its limits.
bool check_interlocks(const Place& at, const BenchConfig& bench);

}  // namespace fogbench::config
