/** Names of what a person may do; each may also do what comes before. */

export type Role = 'look'|'operate'|'configure';
export const ROLES: readonly Role[] = ['look', 'operate', 'configure'];

export const roleOf = (text: string): Role => ROLES.find((role) => role === text) ?? 'look';
