#pragma once
// Every word of a passport's page, in each language, in one table: a text without its translation
// does not compile (passport_texts.cpp).

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "model/compare/conformity.hpp"

namespace fogbench::acceptance {

enum class Language { kEnglish, kRussian };
inline constexpr std::array kLanguages{Language::kEnglish, Language::kRussian};

enum class Text {
  kTitle,
  kLanguageCode,
  kDecimalMark,
  kIssued,
  kGyro,
  kOverallPass,
  kOverallFail,
  kOverallIndeterminate,
  kPass,
  kFail,
  kIndeterminate,
  kNotJudged,
  kRemarks,
  kLimits,
  kRule,
  kQuantity,
  kUnit,
  kTest,
  kValue,
  kUncertainty,
  kConditions,
  kMicrotesla,
  kRemarkNoQuantity,
  kMinimum,
  kMaximum,
  kVerdict,
  kMissing,
  kTooFewTests,
  kRepeatability,
  kDifference,
  kLimit,
  kWithinNoise,
  kBeyondNoise,
  kChange,
  kCoefficients,
  kModel,
  kNotDetermined,
  kPointsOfFit,
  kUncertaintyScope,
  kThermal,
  kSetPoint,
  kTemperature,
  kAverages,
  kDeviation,
  kSigma,
  kMagnetic,
  kAxis,
  kK,
  kClosure,
  kClosureScope,
  kNoise,
  kNoiseTerm,
  kNoiseRecord,
  kNoNoiseRecord,
  kNotSeen,
  kQuantisation,
  kPlots,
  kByTemperature,
  kByField,
  kDeviationAxis,
  kTemperatureAxis,
  kFieldAxis,
  kMarksOfTest,
  kProvenance,
  kRun,
  kProcedure,
  kOperator,
  kBench,
  kSeed,
  kStarted,
  kEnded,
  kOutcome,
  kSoftware,
  kConfiguration,
  kRawData,
  kPoints,
  kPointsVoid,
  kFrames,
  kFramesMissing,
  kIntact,
  kChanged,
  kNotRecorded,
  kCompleted,
  kAborted,
  kFailed,
  kInterrupted,
  kUnderWay,
  kTakenUp,
  kInstruments,
  kInstrument,
  kIdentity,
  kSerialNumber,
  kCalibrated,
  kDue,
  kSignatures,
  kTestedBy,
  kCheckedBy,
  kCustomer,
  kName,
  kSignature,
  kDate,
  kRemarkSimulated,
  kRemarkUnfinished,
  kRemarkRawData,
  kRemarkOverdue,
  kRemarkNoCalibration,
  kRemarkNoOperator,
  kRemarkNoGyro,
  kRemarkNoFit,
  kRemarkFit,
  kCount
};

std::string_view text(Text which, Language language);

/// What a result's identifier is called; the identifier itself for one without a name.
std::string quantity_name(const std::string& quantity, Language language);
/// Whether quantity_name knows it.
bool has_name(const std::string& quantity);
/// A unit of the results ("deg/h per 100 uT") as people write it.
std::string unit_name(const std::string& unit, Language language);
std::string_view role_name(std::string_view role, Language language);
std::string_view verdict_name(model::Conformity verdict, Language language);
/// "completed", "aborted"... of StoredRun::outcome().
std::string_view outcome_name(std::string_view outcome, Language language);

/// A printed number in the language's way: a decimal comma in Russian.
std::string localised(std::string number, Language language);

}  // namespace fogbench::acceptance
