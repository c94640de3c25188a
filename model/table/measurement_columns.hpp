#pragma once
// The columns of the measurement table: what the run log exports and what the effects, the noise
// and the reports know by name. Text in one of them is an error; any other column of numbers is
// something that somebody recorded beside the measurement, and may be a cause.

#include <algorithm>
#include <array>
#include <string_view>

namespace fogbench::model {

inline constexpr std::array<std::string_view, 23> kMeasurementColumns = {"rate_deg_per_h",
                                                                         "rate_std_deg_per_h",
                                                                         "rate_std_error_deg_per_h",
                                                                         "sigma_deg_per_h",
                                                                         "time_s",
                                                                         "duration_s",
                                                                         "temperature_c",
                                                                         "temperature_start_c",
                                                                         "temperature_end_c",
                                                                         "temperature_rate_c_per_h",
                                                                         "temperature_gradient_c",
                                                                         "temperature_control_c",
                                                                         "target_c",
                                                                         "ambient_c",
                                                                         "heater_w",
                                                                         "field_x_ut",
                                                                         "field_y_ut",
                                                                         "field_z_ut",
                                                                         "field_set_ut",
                                                                         "coil_current_a",
                                                                         "current_horizontal_a",
                                                                         "current_vertical_a",
                                                                         "azimuth_deg"};

constexpr bool is_measurement_column(std::string_view name) {
  return std::find(kMeasurementColumns.begin(), kMeasurementColumns.end(), name) !=
         kMeasurementColumns.end();
}

}  // namespace fogbench::model
