#include "config/schemas.hpp"

#include <cassert>

#include "config/describe_bench.hpp"
#include "config/describe_device_file.hpp"
#include "config/describe_model.hpp"
#include "config/describe_procedure.hpp"
#include "config/describe_scenario.hpp"

namespace fogbench::config {
namespace {

ordered_json body_of(std::string_view kind) {
  if (kind == "bench") return schema_of<BenchConfig>();
  if (kind == "device") return schema_of<DeviceFile>();
  if (kind == "scenario") return schema_of<ScenarioConfig>();
  if (kind == "model") return schema_of<ModelFile>();
  if (kind == "limits") return schema_of<LimitsConfig>();
  assert(kind == "procedure");
  ordered_json procedure = schema_of<ProcedureConfig>();
  procedure["definitions"]["step"] = Codec<Step>::definition();
  return procedure;
}

/// Files may name their schema for an editor.
void allow_schema_key(ordered_json& object) {
  object["properties"]["$schema"] = {{"type", "string"}};
}

}  // namespace

std::string schema_text(std::string_view kind) {
  ordered_json schema = {{"$schema", "http://json-schema.org/draft-07/schema#"},
                         {"title", fmt::format("fogbench {} file", kind)}};
  ordered_json body = body_of(kind);
  if (body.contains("oneOf")) {
    for (ordered_json& alternative : body["oneOf"]) allow_schema_key(alternative);
  } else {
    allow_schema_key(body);
  }
  schema.update(body);
  return pretty_json(schema);
}

}  // namespace fogbench::config
