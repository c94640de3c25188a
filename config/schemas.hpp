#pragma once
// The JSON Schemas of all configuration files, written from the same descriptions that read them.

#include <array>
#include <string>
#include <string_view>

namespace fogbench::config {

/// Kinds of files; schemas/<kind>.schema.json holds the schema of each.
inline constexpr std::array<std::string_view, 6> kSchemaKinds = {"bench",     "device", "scenario",
                                                                 "procedure", "model",  "limits"};

/// The text of schemas/<kind>.schema.json (draft-07). Precondition: one of kSchemaKinds.
std::string schema_text(std::string_view kind);

}  // namespace fogbench::config
