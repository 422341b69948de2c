"""Checks manifests of Kubernetes on standard input against its published schema, unknown keys refused.

The package kubernetes-validate brings the schemas of all versions. Asked are the newest, and the one in which the
youngest of the keys used, backoffLimitPerIndex, became stable.
"""
import json
import sys

import kubernetes_validate

STABLE_SINCE = "1.33"

for item in json.load(sys.stdin)["items"]:
    for version in [STABLE_SINCE, kubernetes_validate.latest_version()]:
        found = kubernetes_validate.validate(item, version, strict=True)
        print(item["kind"], item["metadata"]["name"], "valid in", found)
