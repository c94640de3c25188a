#pragma once
// What is probably wrong with a table although it can be read: a time that runs backwards, numbers
// in another unit than they are taken for.

#include <string>
#include <vector>

#include "model/table/table.hpp"

namespace fogbench::model {

/// One sentence each, with the likely cause and what to do. Single stamps that are repeated or step
/// back are row_order's to mend and to say.
std::vector<std::string> doubts(const Table& table);

}  // namespace fogbench::model
