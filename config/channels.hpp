#pragma once
// Every channel of the record, once: its name, which ends in its unit (units.hpp), and what it
// means. Run log, exports, metrics, status, interlocks, measurement tables and their readers take
// them from here; how one is read off a row stands in procedures/channel_values.hpp. A bench adds
// those of its auxiliary sensors (sensor.hpp).

#include <algorithm>
#include <array>
#include <string_view>

namespace fogbench::config {

struct Channel {
  std::string_view name;
  std::string_view meaning;
  /// Of an averaged point too, and so of measurement tables: text in it is an error, and no effect
  /// takes it for something that was recorded by the way.
  bool of_points = true;
};

inline constexpr std::array kChannels = {
    Channel{"time_s", "since the gyro's power-on; of an average the centre of its window"},
    Channel{"duration_s", "length of the averaging window"},
    Channel{"rate_deg_per_h", "mean rate, reference rate subtracted"},
    Channel{"rate_std_deg_per_h", "scatter of the samples in the window"},
    Channel{"rate_std_error_deg_per_h",
            "scatter over sqrt(frames): white noise only, a lower bound"},
    Channel{"sigma_deg_per_h", "scatter as published tables state it"},
    Channel{"temperature_c", "mean of the two working sensors"},
    Channel{"temperature_start_c", "temperature at the window's start, freed of the sensors' lag"},
    Channel{"temperature_end_c", "temperature at the window's end, freed of the sensors' lag"},
    Channel{"temperature_rate_c_per_h", "mean over the window, freed of the sensors' lag"},
    Channel{"temperature_gradient_c", "working sensor 1 minus working sensor 2"},
    Channel{"temperature_working_1_c", "working sensor 1", false},
    Channel{"temperature_working_2_c", "working sensor 2", false},
    Channel{"temperature_control_c", "control sensor"},
    Channel{"target_c", "thermostat's target"},
    Channel{"ambient_c", "air around the gyro"},
    Channel{"heater_w", "heating power, all heaters"},
    Channel{"boost_w", "boost heaters' power", false},
    Channel{"normal_w", "normal heater's power", false},
    Channel{"field_x_ut", "measured field along the gyro's x axis"},
    Channel{"field_y_ut", "measured field along the gyro's y axis"},
    Channel{"field_z_ut", "measured field along the gyro's z axis"},
    Channel{"field_set_ut", "commanded level of a sweep; NULL outside one"},
    Channel{"coil_current_a", "measured current of the energised pair"},
    Channel{"current_horizontal_a", "measured current of the horizontal pair"},
    Channel{"current_vertical_a", "measured current of the vertical pair"},
    Channel{"azimuth_deg", "azimuth of the gyro"},
};

/// Null where there is none of that name.
constexpr const Channel* find_channel(std::string_view name) {
  const auto* const found =
      std::find_if(kChannels.begin(), kChannels.end(),
                   [&](const Channel& channel) { return channel.name == name; });
  return found == kChannels.end() ? nullptr : found;
}

constexpr bool is_point_channel(std::string_view name) {
  const Channel* const channel = find_channel(name);
  return channel != nullptr && channel->of_points;
}

/// What else the tables of the run log and of measurements call a column.
inline constexpr std::array<std::string_view, 10> kOtherColumns = {
    "run",    "kind",           "test",         "block", "segment",
    "frames", "frames_dropped", "void_because", "point", "mode"};

}  // namespace fogbench::config
