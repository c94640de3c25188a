#include "model/table/read_mat.hpp"

#include <fmt/format.h>
#include <matio.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <memory>
#include <span>
#include <utility>

#include "model/table/read_apart.hpp"
#include "model/table/table_choice.hpp"

namespace fogbench::model {
namespace {

constexpr auto kExpectedOfMat =
    "a struct of vectors of one length, vectors of one length, or a matrix with a list of names";

struct MatClose {
  void operator()(mat_t* file) const { Mat_Close(file); }
};
struct VariableFree {
  void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};
using MatVariable = std::unique_ptr<matvar_t, VariableFree>;

/// Rows and columns; none for more dimensions.
std::pair<std::size_t, std::size_t> shape_of(const matvar_t& variable) {
  if (variable.rank != 2 || variable.dims == nullptr) return {0, 0};
  return {variable.dims[0], variable.dims[1]};
}

std::size_t length_of(const matvar_t& variable) {
  const auto [rows, columns] = shape_of(variable);
  return rows == 1 ? columns : columns == 1 ? rows : 0;
}

template <class Number>
void append(const matvar_t& variable, std::size_t first, std::size_t count,
            std::vector<double>& out) {
  const std::span numbers(static_cast<const Number*>(variable.data), first + count);
  for (std::size_t i = first; i < first + count; ++i)
    out.push_back(static_cast<double>(numbers[i]));
}

/// Empty where the variable does not hold real numbers.
std::vector<double> numbers_of(const matvar_t& variable, std::size_t first, std::size_t count) {
  std::vector<double> out;
  if (variable.data == nullptr || variable.isComplex != 0 || variable.data_size <= 0 ||
      (first + count) * static_cast<std::size_t>(variable.data_size) > variable.nbytes) {
    return out;
  }
  out.reserve(count);
  switch (variable.class_type) {
    case MAT_C_DOUBLE:
      append<double>(variable, first, count, out);
      break;
    case MAT_C_SINGLE:
      append<float>(variable, first, count, out);
      break;
    case MAT_C_INT8:
      append<std::int8_t>(variable, first, count, out);
      break;
    case MAT_C_UINT8:
      append<std::uint8_t>(variable, first, count, out);
      break;
    case MAT_C_INT16:
      append<std::int16_t>(variable, first, count, out);
      break;
    case MAT_C_UINT16:
      append<std::uint16_t>(variable, first, count, out);
      break;
    case MAT_C_INT32:
      append<std::int32_t>(variable, first, count, out);
      break;
    case MAT_C_UINT32:
      append<std::uint32_t>(variable, first, count, out);
      break;
    case MAT_C_INT64:
      append<std::int64_t>(variable, first, count, out);
      break;
    case MAT_C_UINT64:
      append<std::uint64_t>(variable, first, count, out);
      break;
    default:
      break;
  }
  return out;
}

/// One string, whichever width its letters have; row `row` of a matrix of letters.
std::string text_of(const matvar_t& variable, std::size_t row = 0) {
  const auto [rows, columns] = shape_of(variable);
  std::string out;
  if (variable.class_type != MAT_C_CHAR || variable.data == nullptr || row >= rows) return out;
  for (std::size_t i = 0; i < columns; ++i) {
    const std::size_t at = row + i * rows;
    std::uint32_t letter = 0;
    if ((at + 1) * static_cast<std::size_t>(variable.data_size) > variable.nbytes) break;
    if (variable.data_size == 1) {
      letter = static_cast<const std::uint8_t*>(variable.data)[at];
      if (variable.data_type == MAT_T_UTF8) {
        out += static_cast<char>(letter);
        continue;
      }
    } else if (variable.data_size == 2) {
      letter = static_cast<const std::uint16_t*>(variable.data)[at];
    }
    if (letter < 0x80) {
      out += static_cast<char>(letter);
    } else if (letter < 0x800) {
      out += static_cast<char>(0xC0 | (letter >> 6));
      out += static_cast<char>(0x80 | (letter & 0x3F));
    } else {
      out += static_cast<char>(0xE0 | (letter >> 12));
      out += static_cast<char>(0x80 | ((letter >> 6) & 0x3F));
      out += static_cast<char>(0x80 | (letter & 0x3F));
    }
  }
  while (out.ends_with(' ') || out.ends_with('\0')) out.pop_back();
  return out;
}

/// The strings of a list or of a matrix of letters; empty for anything else.
std::vector<std::string> texts_of(const matvar_t& variable) {
  std::vector<std::string> out;
  if (variable.class_type == MAT_C_CHAR) {
    for (std::size_t row = 0; row < shape_of(variable).first; ++row) {
      out.push_back(text_of(variable, row));
    }
  } else if (variable.class_type == MAT_C_CELL && variable.data != nullptr) {
    const std::span cells(static_cast<matvar_t* const*>(variable.data), length_of(variable));
    for (const matvar_t* const cell : cells) {
      if (cell == nullptr || cell->class_type != MAT_C_CHAR) return {};
      out.push_back(text_of(*cell));
    }
  }
  return out;
}

/// A vector of numbers or a list of strings.
StoredColumn column_of(const std::string& name, const matvar_t& variable) {
  StoredColumn column{{name, {}}, numbers_of(variable, 0, length_of(variable)), {}};
  if (column.values.empty()) column.texts = texts_of(variable);
  if (column.texts.size() == 1) column.texts.clear();  // a note, not a column
  return column;
}

TableCandidate struct_table(matvar_t& variable) {
  TableCandidate out{variable.name, {}};
  const unsigned fields = Mat_VarGetNumberOfFields(&variable);
  char* const* const names = Mat_VarGetStructFieldnames(&variable);
  for (unsigned i = 0; names != nullptr && i < fields; ++i) {
    const matvar_t* const field = Mat_VarGetStructFieldByIndex(&variable, i, 0);
    if (field != nullptr && names[i] != nullptr) out.columns.push_back(column_of(names[i], *field));
  }
  return out;
}

TableCandidate matrix_table(const matvar_t& variable, const std::vector<MatVariable>& all) {
  const auto [rows, columns] = shape_of(variable);
  TableCandidate out{variable.name, {}};
  std::vector<std::string> names;
  for (const MatVariable& other : all) {
    std::vector<std::string> texts = texts_of(*other);
    if (texts.size() == columns) names = std::move(texts);
  }
  for (std::size_t c = 0; c < columns; ++c) {
    StoredColumn column{{names.empty() ? std::to_string(c + 1) : names[c], {}},
                        numbers_of(variable, c * rows, rows),
                        {}};
    if (!column.values.empty()) out.columns.push_back(std::move(column));
  }
  return out;
}

/// The library takes what is there of a file of level 5 that ends within a variable: each begins
/// with its type and its length, four bytes each.
bool is_cut_off(const std::filesystem::path& file) {
  constexpr std::uint64_t kHeader = 128, kByteOrder = 126, kTag = 8;
  std::error_code ignored;
  const std::uint64_t size = std::filesystem::file_size(file, ignored);
  std::ifstream in(file, std::ios::binary);
  std::array<char, 2> order{};
  in.seekg(kByteOrder).read(order.data(), order.size());
  const bool little = order[0] == 'I';
  std::uint64_t at = kHeader;
  while (at < size) {
    std::array<unsigned char, kTag> tag{};
    if (!in.seekg(static_cast<std::streamoff>(at))
             .read(reinterpret_cast<char*>(tag.data()), kTag)) {
      return true;
    }
    std::uint64_t length = 0;
    for (std::size_t i = 0; i < 4; ++i) length = length << 8 | tag[little ? 7 - i : 4 + i];
    at += kTag + length;
  }
  return at > size;
}

Result<StoredColumns> read_variables(const std::filesystem::path& file, const std::string& wanted) {
  const auto bad = [](std::string message) {
    return Error{ErrorCode::kBadInput, std::move(message)};
  };
  const std::unique_ptr<mat_t, MatClose> open(Mat_Open(file.c_str(), MAT_ACC_RDONLY));
  if (!open) return bad("the MATLAB file is damaged: it cannot be opened");
  std::vector<MatVariable> all;
  bool objects = false;
  while (matvar_t* const next = Mat_VarReadNext(open.get())) {
    if (next->name == nullptr) {
      Mat_VarFree(next);
      objects = true;
      continue;
    }
    all.emplace_back(next);
    objects = objects || next->class_type == MAT_C_OPAQUE || next->class_type == MAT_C_OBJECT;
  }
  const int version = Mat_GetVersion(open.get());
  if (version == MAT_FT_MAT5 && is_cut_off(file)) {
    return bad("the MATLAB file is damaged: it was cut off");
  }
  const std::string format = version == MAT_FT_MAT73  ? "MATLAB 7.3"
                             : version == MAT_FT_MAT4 ? "MATLAB 4"
                                                      : "MATLAB 5";
  std::vector<TableCandidate> candidates;
  TableCandidate vectors{"variables", {}};
  for (const MatVariable& variable : all) {
    const auto [rows, columns] = shape_of(*variable);
    if (variable->class_type == MAT_C_STRUCT && length_of(*variable) == 1) {
      candidates.push_back(struct_table(*variable));
    } else if (length_of(*variable) > 1) {
      StoredColumn column = column_of(variable->name, *variable);
      if (column.rows() > 1) vectors.columns.push_back(std::move(column));
    } else if (rows > 1 && columns > 1 && variable->class_type != MAT_C_CHAR) {
      candidates.push_back(matrix_table(*variable, all));
    }
  }
  const bool has_numbers =
      std::any_of(vectors.columns.begin(), vectors.columns.end(),
                  [](const StoredColumn& column) { return !column.values.empty(); });
  if (has_numbers) candidates.push_back(std::move(vectors));
  const std::string expected = objects ? std::string(kExpectedOfMat) +
                                             "; a MATLAB table or timetable is saved as such by "
                                             "s = table2struct(T, 'ToScalar', true)"
                                       : kExpectedOfMat;
  return the_table(std::move(candidates), wanted, format, expected);
}

}  // namespace

Result<StoredColumns> read_mat(const std::filesystem::path& file, const std::string& wanted) {
  return read_apart([&] { return read_variables(file, wanted); });
}

}  // namespace fogbench::model
