#pragma once
// Whether a page's elements are closed in the order in which they were opened.

#include <string>

namespace fogbench::support {

/// Empty, or what is wrong first: "</p> closes <li>", "a bare '<' in text".
std::string markup_error(const std::string& page);

}  // namespace fogbench::support
