// The one place that names Embree's header and hides the difference between versions 3 and 4: how
// the coherence of a query is told. Internal to this room.
#pragma once

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include "server/visibility/visibility.h"

namespace macula::visibility::embree {

/// The widest packet of coherent rays that may ask for occlusion where there are instances. In
/// Embree 3.13.5 as Debian 12 builds it, rtcOccluded16 stores 16 bits of lanes to be done and reads
/// 64 back (its compiler's error): over instances it now and then never returns.
inline constexpr int kWidestAmongInstances = RTC_VERSION_MAJOR >= 4 ? 16 : 8;

#if RTC_VERSION_MAJOR >= 4
inline RTCRayQueryFlags query_flags(Coherence coherence) {
  return coherence == Coherence::Coherent ? RTC_RAY_QUERY_FLAG_COHERENT
                                          : RTC_RAY_QUERY_FLAG_INCOHERENT;
}
struct IntersectCall {
  RTCIntersectArguments arguments;
  explicit IntersectCall(Coherence coherence) {
    rtcInitIntersectArguments(&arguments);
    arguments.flags = query_flags(coherence);
  }
  void trace(const int*, RTCScene scene, RTCRayHit& r) { rtcIntersect1(scene, &r, &arguments); }
  void trace(const int* valid, RTCScene scene, RTCRayHit8& r) {
    rtcIntersect8(valid, scene, &r, &arguments);
  }
  void trace(const int* valid, RTCScene scene, RTCRayHit16& r) {
    rtcIntersect16(valid, scene, &r, &arguments);
  }
};
struct OccludedCall {
  RTCOccludedArguments arguments;
  explicit OccludedCall(Coherence coherence) {
    rtcInitOccludedArguments(&arguments);
    arguments.flags = query_flags(coherence);
  }
  void trace(const int*, RTCScene scene, RTCRay& r) { rtcOccluded1(scene, &r, &arguments); }
  void trace(const int* valid, RTCScene scene, RTCRay8& r) {
    rtcOccluded8(valid, scene, &r, &arguments);
  }
  void trace(const int* valid, RTCScene scene, RTCRay16& r) {
    rtcOccluded16(valid, scene, &r, &arguments);
  }
  /// Embree 4 has no streams.
  void trace(RTCScene scene, RTCRay* rays, unsigned count) {
    for (unsigned i = 0; i < count; ++i) rtcOccluded1(scene, rays + i, &arguments);
  }
};
#else
struct ContextCall {
  RTCIntersectContext context;
  explicit ContextCall(Coherence coherence) {
    rtcInitIntersectContext(&context);
    context.flags = coherence == Coherence::Coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT
                                                     : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  }
};
struct IntersectCall : ContextCall {
  using ContextCall::ContextCall;
  void trace(const int*, RTCScene scene, RTCRayHit& r) { rtcIntersect1(scene, &context, &r); }
  void trace(const int* valid, RTCScene scene, RTCRayHit8& r) {
    rtcIntersect8(valid, scene, &context, &r);
  }
  void trace(const int* valid, RTCScene scene, RTCRayHit16& r) {
    rtcIntersect16(valid, scene, &context, &r);
  }
};
struct OccludedCall : ContextCall {
  using ContextCall::ContextCall;
  void trace(const int*, RTCScene scene, RTCRay& r) { rtcOccluded1(scene, &context, &r); }
  void trace(const int* valid, RTCScene scene, RTCRay8& r) {
    rtcOccluded8(valid, scene, &context, &r);
  }
  void trace(const int* valid, RTCScene scene, RTCRay16& r) {
    rtcOccluded16(valid, scene, &context, &r);
  }
  /// Rays of any directions together: nodes are fetched once for all of them that pass.
  void trace(RTCScene scene, RTCRay* rays, unsigned count) {
    rtcOccluded1M(scene, &context, rays, count, sizeof(RTCRay));
  }
};
#endif

}  // namespace macula::visibility::embree
