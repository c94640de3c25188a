#pragma once
// The study's records as a Markdown page: the figures against their goals, then the confusion of
// every part.

#include <string>
#include <vector>

#include "tests/benchmark/study_record.hpp"

namespace fogbench::tests {

/// `command`: the one that made the page, to be printed on it.
std::string study_page(const std::vector<Record>& records, const std::string& command);

/// How long a verdict on a table of usual size took; empty: there was none. On a machine that did
/// nothing else, with one thread.
std::string times_text(const std::vector<Record>& records);

/// "96.0 % (91.5 ... 98.3)" with Wilson's 95 % interval; "-" without trials.
std::string rate_text(std::size_t hits, std::size_t trials);

}  // namespace fogbench::tests
