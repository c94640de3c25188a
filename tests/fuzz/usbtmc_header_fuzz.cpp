// The headers of USBTMC's bulk transfers, as the served supply meets them.

#include <string>

#include "simulator/wire/usbtmc_protocol.hpp"
#include "tests/fuzz/fuzz_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fogbench;             // NOLINT(google-build-using-namespace)
  using namespace fogbench::simulator;  // NOLINT(google-build-using-namespace)
  if (const auto header = parse_usbtmc_header(ByteView(data, size))) {
    fuzz::require(size >= kUsbtmcHeaderBytes);
    fuzz::require(header->tag != 0 && data[1] == header->tag);
    fuzz::require(data[2] == static_cast<std::uint8_t>(~header->tag));
  }
  // An answer is a header of its own, with the same tag and the text's size.
  fuzz::Input input(data, size);
  const std::uint8_t tag = input.byte();
  const std::string text = input.line();
  const Bytes answer = encode_usbtmc_answer(tag, text, true);
  fuzz::require(answer.size() % 4 == 0 && answer.size() >= kUsbtmcHeaderBytes + text.size());
  const auto back = parse_usbtmc_header(answer);
  fuzz::require(back.has_value() == (tag != 0));
  if (back) fuzz::require(back->tag == tag && back->size == text.size());
  return 0;
}
