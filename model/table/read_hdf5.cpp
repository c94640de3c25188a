#include "model/table/read_hdf5.hpp"

#include <fmt/format.h>
#include <hdf5.h>

#include <map>
#include <utility>

#include "model/table/read_apart.hpp"
#include "model/table/read_text.hpp"
#include "model/table/table_choice.hpp"
#include "model/table/text_fields.hpp"

namespace fogbench::model {
namespace {

constexpr auto kExpectedOfHdf5 = "a group of data sets of one length, or a data set of records";
constexpr hsize_t kMostRows = hsize_t{1} << 31;

/// An identifier of the library, given back when it goes.
class Id {
 public:
  using Close = herr_t (*)(hid_t);
  Id(hid_t id, Close close) : id_(id), close_(close) {}
  ~Id() {
    if (id_ >= 0) close_(id_);
  }
  Id(const Id&) = delete;
  Id& operator=(const Id&) = delete;
  hid_t get() const { return id_; }
  explicit operator bool() const { return id_ >= 0; }

 private:
  hid_t id_;
  Close close_;
};

std::vector<hsize_t> extent_of(hid_t space) {
  const int rank = H5Sget_simple_extent_ndims(space);
  if (rank < 0) return {};
  std::vector<hsize_t> shape(static_cast<std::size_t>(rank));
  if (H5Sget_simple_extent_dims(space, shape.data(), nullptr) < 0) return {};
  return shape;
}

/// Strings of a data set or of an attribute, `count` of them; `read` fills memory of a given type.
template <class Read>
std::vector<std::string> strings(hid_t type, hid_t space, std::size_t count, const Read& read) {
  std::vector<std::string> out;
  if (H5Tis_variable_str(type) > 0) {
    const Id memory(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(memory.get(), H5T_VARIABLE);
    H5Tset_cset(memory.get(), H5Tget_cset(type));
    std::vector<char*> pointers(count, nullptr);
    if (read(memory.get(), pointers.data()) < 0) return {};
    for (const char* const text : pointers) out.emplace_back(text == nullptr ? "" : text);
    H5Dvlen_reclaim(memory.get(), space, H5P_DEFAULT, pointers.data());
    return out;
  }
  const std::size_t size = H5Tget_size(type);
  constexpr std::size_t kLongest = 4096;
  if (size == 0 || size > kLongest) return {};
  std::vector<char> bytes(size * count);
  if (read(type, bytes.data()) < 0) return {};
  for (std::size_t i = 0; i < count; ++i) {
    const std::string_view text(bytes.data() + i * size, size);
    out.emplace_back(trimmed(text.substr(0, text.find('\0'))));
  }
  return out;
}

std::vector<std::string> attribute(hid_t object, const char* name) {
  if (H5Aexists(object, name) <= 0) return {};
  const Id held(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  if (!held) return {};
  const Id type(H5Aget_type(held.get()), H5Tclose), space(H5Aget_space(held.get()), H5Sclose);
  const hssize_t count = H5Sget_simple_extent_npoints(space.get());
  if (H5Tget_class(type.get()) != H5T_STRING || count < 1 ||
      count > static_cast<hssize_t>(kMostColumns)) {
    return {};
  }
  return strings(type.get(), space.get(), static_cast<std::size_t>(count),
                 [&](hid_t memory, void* into) { return H5Aread(held.get(), memory, into); });
}

std::string unit_of_object(hid_t object) {
  for (const char* const name : {"units", "unit", "Units", "Unit"}) {
    const auto found = attribute(object, name);
    if (found.size() == 1) return found.front();
  }
  return {};
}

class Hdf5File {
 public:
  explicit Hdf5File(hid_t file) : file_(file) {}

  /// Goes through all groups.
  bool visit() {
    return H5Ovisit(
               file_, H5_INDEX_NAME, H5_ITER_NATIVE,
               [](hid_t, const char* name, const H5O_info_t* info, void* self) -> herr_t {
                 auto& file = *static_cast<Hdf5File*>(self);
                 if (info->type == H5O_TYPE_DATASET) file.take(std::string("/") + name);
                 if (info->type == H5O_TYPE_GROUP) file.look_at(name);
                 return 0;
               },
               this) >= 0;
  }

  bool is_pandas() const { return pandas_; }
  bool was_unreadable() const { return unreadable_; }
  std::vector<TableCandidate> take_candidates() {
    for (auto& [group, columns] : groups_) candidates_.push_back({group, std::move(columns)});
    return std::move(candidates_);
  }

 private:
  void look_at(const char* name) {
    const Id group(H5Oopen(file_, name, H5P_DEFAULT), H5Oclose);
    pandas_ = pandas_ || (group && H5Aexists(group.get(), "pandas_type") > 0);
  }

  void take(const std::string& path) {
    const Id data(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), H5Dclose);
    if (!data) {
      unreadable_ = true;
      return;
    }
    const Id type(H5Dget_type(data.get()), H5Tclose), space(H5Dget_space(data.get()), H5Sclose);
    std::vector<hsize_t> shape = extent_of(space.get());
    if (shape.size() == 2 && (shape[0] == 1 || shape[1] == 1)) shape = {shape[0] * shape[1]};
    const auto [group, name] = place_of(path);
    if (shape.empty() || shape[0] == 0 || shape[0] > kMostRows) return;
    const auto rows = static_cast<std::size_t>(shape[0]);
    const H5T_class_t kind = H5Tget_class(type.get());
    if (shape.size() == 1 && kind == H5T_COMPOUND) {
      take_records(path, data.get(), type.get(), rows);
    } else if (shape.size() == 1 && (kind == H5T_FLOAT || kind == H5T_INTEGER)) {
      StoredColumn column{{name, unit_of_object(data.get())}, std::vector<double>(rows), {}};
      if (read(data.get(), H5T_NATIVE_DOUBLE, column.values.data())) {
        groups_[group].push_back(std::move(column));
      }
    } else if (shape.size() == 1 && kind == H5T_STRING) {
      StoredColumn column{{name, {}}, {}, {}};
      column.texts = strings(type.get(), space.get(), rows, [&](hid_t memory, void* into) {
        return H5Dread(data.get(), memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, into);
      });
      if (column.texts.size() == rows) groups_[group].push_back(std::move(column));
    } else if (shape.size() == 2 && (kind == H5T_FLOAT || kind == H5T_INTEGER)) {
      take_matrix(path, data.get(), rows, shape[1]);
    }
  }

  /// Group and name of a data set. Octave makes each variable a group that holds its "value".
  std::pair<std::string, std::string> place_of(const std::string& path) const {
    std::string inner = path;
    if (inner.ends_with("/value")) {
      inner.resize(inner.size() - std::string_view("/value").size());
      const Id group(H5Oopen(file_, inner.c_str(), H5P_DEFAULT), H5Oclose);
      if (!group || H5Aexists(group.get(), "OCTAVE_NEW_FORMAT") <= 0) inner = path;
    }
    const std::size_t slash = inner.rfind('/');
    return {slash == 0 ? "/" : inner.substr(0, slash), inner.substr(slash + 1)};
  }

  bool read(hid_t data, hid_t memory, void* into) {
    if (H5Dread(data, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, into) >= 0) return true;
    unreadable_ = true;
    return false;
  }

  void take_records(const std::string& path, hid_t data, hid_t type, std::size_t rows) {
    TableCandidate out{path, {}};
    const int members = H5Tget_nmembers(type);
    for (int i = 0; i < members; ++i) {
      const auto index = static_cast<unsigned>(i);
      const H5T_class_t kind = H5Tget_member_class(type, index);
      if (kind != H5T_FLOAT && kind != H5T_INTEGER) continue;
      char* const name = H5Tget_member_name(type, index);
      if (name == nullptr) continue;
      const Id memory(H5Tcreate(H5T_COMPOUND, sizeof(double)), H5Tclose);
      H5Tinsert(memory.get(), name, 0, H5T_NATIVE_DOUBLE);
      StoredColumn column{{name, {}}, std::vector<double>(rows), {}};
      H5free_memory(name);
      if (read(data, memory.get(), column.values.data())) out.columns.push_back(std::move(column));
    }
    candidates_.push_back(std::move(out));
  }

  void take_matrix(const std::string& path, hid_t data, std::size_t rows, hsize_t columns) {
    if (columns > kMostColumns || rows * columns > kMostRows) return;
    std::vector<std::string> names;
    for (const char* const key : {"columns", "names", "column_names", "labels"}) {
      if (names.empty()) names = attribute(data, key);
    }
    const auto width = static_cast<std::size_t>(columns);
    std::vector<double> all(rows * width);
    if (!read(data, H5T_NATIVE_DOUBLE, all.data())) return;
    TableCandidate out{path, {}};
    for (std::size_t c = 0; c < width; ++c) {
      StoredColumn column{{names.size() == width ? names[c] : std::to_string(c + 1), {}}, {}, {}};
      column.values.reserve(rows);
      for (std::size_t row = 0; row < rows; ++row) column.values.push_back(all[row * width + c]);
      out.columns.push_back(std::move(column));
    }
    candidates_.push_back(std::move(out));
  }

  hid_t file_;
  std::map<std::string, std::vector<StoredColumn>> groups_;
  std::vector<TableCandidate> candidates_;
  bool pandas_ = false, unreadable_ = false;
};

Result<StoredColumns> read_data_sets(const std::filesystem::path& path, const std::string& wanted) {
  const auto bad = [](const char* what) { return Error{ErrorCode::kBadInput, what}; };
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  const Id file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (!file) return bad("the HDF5 file is damaged or cut off: it cannot be opened");
  Hdf5File inside(file.get());
  if (!inside.visit() || inside.was_unreadable()) {
    return bad("the HDF5 file is damaged or cut off: not all of it can be read");
  }
  if (inside.is_pandas()) {
    return bad(
        "found a store of pandas, expected plain data sets: write it with to_csv, or each column "
        "with h5py");
  }
  return the_table(inside.take_candidates(), wanted, "HDF5", kExpectedOfHdf5);
}

}  // namespace

Result<StoredColumns> read_hdf5(const std::filesystem::path& file, const std::string& wanted) {
  return read_apart([&] { return read_data_sets(file, wanted); });
}

}  // namespace fogbench::model
