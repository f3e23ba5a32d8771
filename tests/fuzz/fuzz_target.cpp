// A libFuzzer target of one reader, BURNISH_FUZZ_READER. Whatever the bytes are, the reader returns
// or throws an Error of the library.
#include <cstdint>

#include "burnish/error.h"
#include "fuzz/readers.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    static const burnish::fuzz::Folder folder(*burnish::fuzz::find_reader(BURNISH_FUZZ_READER));
    try {
        folder.read({reinterpret_cast<const char*>(bytes), size});
    } catch (const burnish::Error&) {
    }
    return 0;
}
