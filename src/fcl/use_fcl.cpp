#include "pcphys/fcl.h"

#include "collision/hook.h"
#include "fcl/fcl_narrow.h"

namespace pcphys {

Status use_fcl() {
  if (!fcl_available())
    return Error{ErrorCode::unavailable,
                 "This build has no FCL; install libfcl-dev and build again, or use the native narrow phase."};
  fcl_hook() = {narrow_fcl, narrow_fcl};
  return {};
}

}  // namespace pcphys
