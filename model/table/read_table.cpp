#include "model/table/read_table.hpp"

#include <fmt/format.h>

#include <array>
#include <string_view>
#include <utility>

#include "model/table/byte_source.hpp"
#include "model/table/read_hdf5.hpp"
#include "model/table/read_mat.hpp"
#include "model/table/read_text.hpp"
#include "model/table/stored_columns.hpp"

namespace fogbench::model {
namespace {

/// What is known by its beginning and is no table.
struct Foreign {
  std::string_view beginning;
  const char* says;
};

constexpr std::array<Foreign, 7> kForeign = {
    {{"PK\x03\x04",
      "found a spreadsheet (xlsx, ods) or a zip archive, expected a table of text: "
      "save it as CSV"},
     {"\xD0\xCF\x11\xE0",
      "found an old spreadsheet (xls), expected a table of text: save it as CSV"},
     {"SQLite format 3", "found a run log, expected a run of it to be named: FILE#NUMBER"},
     {"\xFD"
      "7zXZ",
      "found an xz archive, expected gzip or zstd: unpack it first"},
     {"BZh", "found a bzip2 archive, expected gzip or zstd: unpack it first"},
     {"PAR1", "found a Parquet file, expected text, MATLAB or HDF5: write it with to_csv"},
     {"\x93NUMPY",
      "found an array of numpy, expected text, MATLAB or HDF5: write it with savetxt"}}};

/// What is looked at to recognise a format: a MATLAB file says what it is in its first 116 bytes
/// and its order of bytes at 126, HDF5 may stand behind a block of 512.
constexpr std::size_t kFirstBytes = 528;
constexpr std::string_view kHdf5 = "\x89HDF\r\n\x1a\n";
constexpr std::size_t kUserBlock = 512;

/// Level 4 has no name: type, rows, columns, 0 and the length of a name, little endian.
bool is_mat4(std::string_view bytes) {
  constexpr std::size_t kHeader = 20;
  if (bytes.size() <= kHeader) return false;
  const auto word = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 4; i-- > 0;)
      value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
    return value;
  };
  constexpr std::uint32_t kLongestName = 64;
  const std::uint32_t type = word(0), name = word(16);
  return type < 53 && type % 10 <= 2 && word(4) > 0 && word(8) > 0 && word(12) <= 1 && name > 1 &&
         name < kLongestName && bytes[kHeader] > ' ';
}

}  // namespace

Result<Table> read_table(const std::filesystem::path& file, const ReadOptions& options,
                         const std::string& inside) {
  const auto bad = [&](std::string_view what) {
    return Error{ErrorCode::kBadInput, fmt::format("{}: {}", file.string(), what)};
  };
  auto opened = open_bytes(file);
  if (!opened) return opened.error();
  auto first = first_bytes(*opened->bytes, kFirstBytes);
  if (!first) return bad(first.error().message);
  for (const Foreign& foreign : kForeign) {
    if (first->starts_with(foreign.beginning)) return bad(foreign.says);
  }
  const std::string_view bytes = *first;
  const bool hdf5 = bytes.starts_with(kHdf5);
  const bool mat = bytes.starts_with("MATLAB 5.0 MAT-file") ||
                   (bytes.size() > kUserBlock && bytes.substr(kUserBlock).starts_with(kHdf5)) ||
                   is_mat4(bytes);
  if ((hdf5 || mat) && !opened->archive.empty()) {
    return bad(
        fmt::format("found a binary file in a {} archive: unpack it first", opened->archive));
  }
  if (hdf5 || mat) {
    auto stored = mat ? read_mat(file, inside) : read_hdf5(file, inside);
    if (!stored) return bad(stored.error().message);
    return table_of(file, std::move(*stored), options);
  }
  if (!inside.empty())
    return bad(fmt::format("found a table of text, which has no part {}", inside));
  opened->bytes = put_back(std::move(*first), std::move(opened->bytes));
  return read_text_table(file, std::move(*opened), options);
}

}  // namespace fogbench::model
