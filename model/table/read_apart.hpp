#pragma once
// Libraries that read binary formats trust their files: a damaged one may make them crash, loop or
// ask for all memory. So they read in a process of their own, which hands over the columns, and
// whatever becomes of it is one line here.

#include <functional>

#include "config/result.hpp"
#include "model/table/stored_columns.hpp"

namespace fogbench::model {

/// What `read` returns, in a child process. Errors: those of `read`; kBadInput where the child does
/// not live to tell.
Result<StoredColumns> read_apart(const std::function<Result<StoredColumns>()>& read);

}  // namespace fogbench::model
