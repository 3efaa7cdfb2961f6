#!/usr/bin/env bash
# Ends with 0 if the service of this container is ready: /readyz answers 200 within 2 s. A shell is enough for it, so
# no Python starts every ten seconds.
set -u
exec 2>/dev/null
port=${ASSUR_PORT:-8000}
exec 3<>"/dev/tcp/127.0.0.1/$port" || exit 1
printf 'GET /readyz HTTP/1.1\r\nHost: 127.0.0.1:%s\r\nConnection: close\r\n\r\n' "$port" >&3 || exit 1
read -r -t 2 _ status _ <&3 || exit 1
[[ $status == 200 ]]
