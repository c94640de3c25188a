#include "config/device_file.hpp"

#include <array>
#include <utility>

#include "config/describe_device.hpp"
#include "config/describe_device_file.hpp"
#include "config/describe_sensor.hpp"
#include "config/house_units.hpp"
#include "config/json_file.hpp"

namespace fogbench::config {
namespace {

/// In the order of the variant.
constexpr std::array<std::string_view, std::variant_size_v<DeviceFile>> kDeviceKinds = {
    "modbus", "scpi", "hid", "frame", "modbus_sensor", "scpi_sensor", "hid_sensor", "line_sensor"};

/// The channels' names say their units.
template <class Sensor>
bool take_to_house_units(const Place& /*at*/, Sensor& /*sensor*/) {
  return true;
}

template <std::size_t... I>
bool read_kind(std::string_view kind, const Place& at, DeviceFile& out,
               std::index_sequence<I...> /*all*/) {
  bool ok = false;
  const auto read = [&]<std::size_t K>(std::integral_constant<std::size_t, K> /*which*/) {
    using Device = std::variant_alternative_t<K, DeviceFile>;
    auto& device = out.emplace<K>();
    ok = Codec<Device>::read(at, device, {});
    ok = take_to_house_units(at, device) && ok;
  };
  const bool known =
      ((kDeviceKinds[I] == kind && (read(std::integral_constant<std::size_t, I>{}), true)) || ...);
  return known ? ok : (at / "kind").wrong(fmt::format("one of {}", fmt::join(kDeviceKinds, ", ")));
}

template <std::size_t... I>
ordered_json all_schemas(std::index_sequence<I...> /*all*/) {
  return {{"oneOf", {schema_of<std::variant_alternative_t<I, DeviceFile>>()...}}};
}

using All = std::make_index_sequence<kDeviceKinds.size()>;

}  // namespace

std::string_view kind_of(const DeviceFile& device) {
  return kDeviceKinds[device.index()];
}

bool Codec<DeviceFile>::read(const Place& at, DeviceFile& out, const Rule& /*rule*/) {
  if (!at.value().is_object()) return at.wrong("an object");
  const Place kind = at / "kind";
  const bool named = kind.present() && kind.value().is_string();
  return read_kind(named ? kind.value().get_ref<const std::string&>() : std::string(), at, out,
                   All{});
}

ordered_json Codec<DeviceFile>::schema(const Rule& /*rule*/) {
  return all_schemas(All{});
}

ordered_json Codec<DeviceFile>::write(const DeviceFile& device) {
  return std::visit([](const auto& d) { return Codec<std::decay_t<decltype(d)>>::write(d); },
                    device);
}

Result<DeviceFile> load_device(const std::filesystem::path& file) {
  return read_config<DeviceFile>(file);
}

std::vector<Error> check_device(const std::filesystem::path& file, DeviceFile& out) {
  return read_config(file, out);
}

}  // namespace fogbench::config
